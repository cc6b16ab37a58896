#include "core/cut/corners.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/mesh/topology.h"
#include "core/mesh/union_find.h"

namespace arap {
namespace {

// Corners are numbered 3·triangle + k, as the sides are: a side starts at the corner numbered
// NextSide(side) and ends at PreviousSide(side).
std::uint32_t StartCorner(std::uint32_t side) { return NextSide(side); }
std::uint32_t EndCorner(std::uint32_t side) { return PreviousSide(side); }

}  // namespace

std::vector<std::uint32_t> TouchingVertices(std::size_t vertex_count,
                                            std::span<const Triangle> triangles,
                                            std::span<const Side> sides) {
  UnionFind corners(3 * triangles.size());
  ForEachEdge(sides, [&](std::span<const Side> edge) {
    const std::uint32_t first = edge[0].index;
    for (const Side& side : edge.subspan(1)) {
      const bool alike = SideStart(triangles, side.index) == SideStart(triangles, first);
      corners.Join(StartCorner(first), alike ? StartCorner(side.index) : EndCorner(side.index));
      corners.Join(EndCorner(first), alike ? EndCorner(side.index) : StartCorner(side.index));
    }
  });
  std::vector<std::uint32_t> fan(vertex_count, kNone);
  std::vector<bool> touching(vertex_count, false);
  for (std::uint32_t c = 0; c < 3 * triangles.size(); ++c) {
    const std::uint32_t v = triangles[c / 3][c % 3], root = corners.Find(c);
    if (fan[v] == kNone) fan[v] = root;
    if (fan[v] != root) touching[v] = true;
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t v = 0; v < vertex_count; ++v) {
    if (touching[v]) found.push_back(v);
  }
  return found;
}

SplitVertices Split(std::size_t vertex_count, std::span<const Triangle> triangles,
                    const Gluing& gluing) {
  UnionFind corners(3 * triangles.size());
  for (std::uint32_t side = 0; side < 3 * triangles.size(); ++side) {
    const std::uint32_t mate = gluing.mate[side];
    if (gluing.open(side) || mate < side) continue;
    corners.Join(StartCorner(side), EndCorner(mate));
    corners.Join(EndCorner(side), StartCorner(mate));
  }
  SplitVertices split;
  split.triangles.assign(triangles.begin(), triangles.end());
  split.source.resize(vertex_count);
  std::iota(split.source.begin(), split.source.end(), 0u);
  std::vector<bool> used(vertex_count, false);
  for (std::uint32_t c = 0; c < 3 * triangles.size(); ++c) {
    const std::uint32_t v = triangles[c / 3][c % 3], root = corners.Find(c);
    // The root is the lowest corner of its fan: it comes first and numbers the others.
    std::uint32_t& vertex = split.triangles[c / 3][c % 3];
    if (root != c) {
      vertex = split.triangles[root / 3][root % 3];
    } else if (used[v]) {
      vertex = static_cast<std::uint32_t>(split.source.size());
      split.source.push_back(v);
    }
    used[v] = true;
  }
  return split;
}

std::vector<std::uint32_t> JoinUnparted(const SplitVertices& split, std::span<const Side> sides,
                                        Gluing& gluing) {
  std::vector<std::uint32_t> joined;
  std::vector<std::array<std::uint32_t, 3>> ends;  // lower vertex, higher vertex, side
  ForEachEdge(sides, [&](std::span<const Side> edge) {
    if (edge.size() < 2 || !gluing.open(edge[0].index)) return;
    ends.clear();
    for (const Side& side : edge) {
      const auto [low, high] = std::minmax(
          {SideStart(split.triangles, side.index), SideEnd(split.triangles, side.index)});
      ends.push_back({low, high, side.index});
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 1; i < ends.size(); ++i) {
      const auto &a = ends[i - 1], &b = ends[i];
      if (a[0] != b[0] || a[1] != b[1]) continue;
      if (gluing.cut[a[2]]) joined.push_back(a[2]);
      gluing.mate[a[2]] = b[2], gluing.mate[b[2]] = a[2];
      gluing.Join(a[2]);
    }
  });
  return joined;
}

}  // namespace arap
