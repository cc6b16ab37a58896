#include "core/cut/pieces.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "core/mesh/space.h"
#include "core/mesh/topology.h"

namespace arap {
namespace {

// Corners are numbered 3·triangle + k, as the sides are: a side starts at the corner numbered
// NextSide(side) and ends at PreviousSide(side).
std::uint32_t StartCorner(std::uint32_t side) { return NextSide(side); }
std::uint32_t EndCorner(std::uint32_t side) { return PreviousSide(side); }

// Lengths closer than this, relatively, are equal: rounding must not choose the outline.
constexpr double kTie = 1e-9;

// Where the boundary edge that starts at a vertex ends; kNone off the boundary.
std::vector<std::uint32_t> Successors(const SurfaceMesh& mesh, const Topology& topology) {
  std::vector<std::uint32_t> next(mesh.vertices.size(), kNone);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& c = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      if (topology.edges[topology.triangle_edges[t][k]].boundary()) {
        next[c[(k + 1) % 3]] = c[(k + 2) % 3];
      }
    }
  }
  return next;
}

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

std::string Piece::Describe() const {
  if (closed()) return genus == 0 ? "closed" : fmt::format("closed, of genus {}", genus);
  return fmt::format("of genus {} with {} {}", genus, boundary_starts.size(),
                     boundary_starts.size() == 1 ? "boundary" : "boundaries");
}

std::vector<Piece> FindPieces(std::size_t vertex_count, std::span<const Triangle> triangles,
                              const Gluing& gluing) {
  UnionFind sets(triangles.size());
  for (std::uint32_t side = 0; side < gluing.mate.size(); ++side) {
    if (!gluing.open(side)) sets.Join(side / 3, gluing.mate[side] / 3);
  }
  std::vector<Piece> pieces;
  std::vector<std::uint32_t> piece_of(triangles.size());
  std::vector<bool> vertex_seen(vertex_count, false), side_seen(gluing.mate.size(), false);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t root = sets.Find(t);
    if (root == t) pieces.emplace_back();
    piece_of[t] = root == t ? static_cast<std::uint32_t>(pieces.size() - 1) : piece_of[root];
    Piece& piece = pieces[piece_of[t]];
    piece.triangles.push_back(t);
    // Euler characteristic V − E + F, with E = (3F + open sides) / 2; here −(F + open sides).
    piece.euler -= 1;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[t][k], side = 3 * t + k;
      if (!vertex_seen[v]) piece.vertices.push_back(v);
      vertex_seen[v] = true;
      if (!gluing.open(side)) continue;
      piece.euler -= 1;
      if (side_seen[side]) continue;
      piece.boundary_starts.push_back(side);
      for (std::uint32_t s = side; !side_seen[s]; s = gluing.NextOpen(s)) side_seen[s] = true;
    }
  }
  for (Piece& piece : pieces) {
    piece.euler = (piece.euler + 2 * static_cast<std::int64_t>(piece.vertices.size())) / 2;
    piece.genus = (2 - static_cast<std::int64_t>(piece.boundary_starts.size()) - piece.euler) / 2;
  }
  return pieces;
}

std::vector<BoundaryLoop> BoundaryLoops(const SurfaceMesh& mesh, const Topology& topology) {
  std::vector<std::uint32_t> next = Successors(mesh, topology);
  std::vector<BoundaryLoop> loops;
  for (std::uint32_t start = 0; start < next.size(); ++start) {
    if (next[start] == kNone) continue;
    BoundaryLoop& loop = loops.emplace_back();
    loop.component = topology.vertex_component[start];
    for (std::uint32_t v = start; next[v] != kNone;) {
      loop.vertices.push_back(v);
      loop.length += (Vec(mesh.vertices[next[v]]) - Vec(mesh.vertices[v])).norm();
      v = std::exchange(next[v], kNone);
    }
  }
  std::stable_sort(loops.begin(), loops.end(), [](const BoundaryLoop& a, const BoundaryLoop& b) {
    return a.component < b.component;
  });
  for (auto begin = loops.begin(), end = begin; begin != loops.end(); begin = end) {
    auto longest = begin;
    for (; end != loops.end() && end->component == begin->component; ++end) {
      if (end->length > longest->length * (1 + kTie)) longest = end;
    }
    std::rotate(begin, longest, longest + 1);
  }
  return loops;
}

}  // namespace arap
