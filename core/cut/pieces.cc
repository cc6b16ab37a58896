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
std::vector<std::uint32_t> Successors(const SurfaceMesh& mesh, std::span<const Side> sides) {
  std::vector<std::uint32_t> next(mesh.vertices.size(), kNone);
  ForEachEdge(sides, [&](std::span<const Side> edge) {
    if (edge.size() > 1) return;
    const std::uint32_t side = edge[0].index;
    next[SideStart(mesh.triangles, side)] = SideEnd(mesh.triangles, side);
  });
  return next;
}

// Marks the vertices whose triangles are not one fan or ring, where no edge has more than two.
class FanWalk {
 public:
  FanWalk(std::size_t vertex_count, std::span<const Triangle> triangles, const Gluing& gluing)
      : triangles_(triangles),
        gluing_(gluing),
        seen_(3 * triangles.size(), false),
        touching_(vertex_count, false) {}

  std::vector<bool> Run() {
    std::vector<bool> known(touching_.size(), false);
    for (std::uint32_t c = 0; c < seen_.size(); ++c) {
      if (seen_[c]) continue;
      const std::uint32_t v = triangles_[c / 3][c % 3];
      if (known[v]) touching_[v] = true;
      known[v] = true;
      seen_[c] = true;
      // All the way round, or to both ends of the fan.
      if (!Walk(v, c, NextSide(c))) Walk(v, c, PreviousSide(c));
    }
    return std::move(touching_);
  }

 private:
  // From corner `start` at v out through `side`; whether it comes back to where it began.
  bool Walk(std::uint32_t v, std::uint32_t start, std::uint32_t side) {
    while (true) {
      const std::uint32_t mate = gluing_.mate[side];
      if (mate == kNone) return false;
      // Of the two ends of the mate one is v, and the other one's side is where the walk goes on.
      const std::uint32_t next = NextSide(mate), previous = PreviousSide(mate);
      const bool at_next = triangles_[mate / 3][next % 3] == v;
      const std::uint32_t corner = at_next ? next : previous;
      if (corner == start) return true;
      seen_[corner] = true;
      side = at_next ? previous : next;
    }
  }

  std::span<const Triangle> triangles_;
  const Gluing& gluing_;
  std::vector<bool> seen_;      // 3·#F, corners
  std::vector<bool> touching_;  // #V
};

// The same, with edges of three and more triangles joining them all.
std::vector<bool> JoinFans(std::size_t vertex_count, std::span<const Triangle> triangles,
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
  return touching;
}

// The piece of each triangle, numbered by their lowest triangle; `sizes` gets the triangles of each.
std::vector<std::uint32_t> PieceOfEach(const Gluing& gluing, std::vector<std::size_t>& sizes) {
  std::vector<std::uint32_t> piece_of(gluing.mate.size() / 3, kNone), queue;
  for (std::uint32_t start = 0; start < piece_of.size(); ++start) {
    if (piece_of[start] != kNone) continue;
    const auto piece = static_cast<std::uint32_t>(sizes.size());
    sizes.push_back(1);
    piece_of[start] = piece;
    queue.assign(1, start);
    while (!queue.empty()) {
      const std::uint32_t t = queue.back();
      queue.pop_back();
      for (std::uint32_t side = 3 * t; side < 3 * t + 3; ++side) {
        if (gluing.open(side)) continue;
        std::uint32_t& of_mate = piece_of[gluing.mate[side] / 3];
        if (of_mate != kNone) continue;
        of_mate = piece;
        ++sizes.back();
        queue.push_back(gluing.mate[side] / 3);
      }
    }
  }
  return piece_of;
}

}  // namespace

std::vector<std::uint32_t> TouchingVertices(std::size_t vertex_count,
                                            std::span<const Triangle> triangles,
                                            std::span<const Side> sides, const Gluing& gluing) {
  bool crowded = false;
  ForEachEdge(sides, [&](std::span<const Side> edge) { crowded = crowded || edge.size() > 2; });
  const std::vector<bool> touching = crowded ? JoinFans(vertex_count, triangles, sides)
                                             : FanWalk(vertex_count, triangles, gluing).Run();
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
  std::vector<std::size_t> sizes;
  const std::vector<std::uint32_t> piece_of = PieceOfEach(gluing, sizes);
  std::vector<Piece> pieces(sizes.size());
  for (std::size_t p = 0; p < sizes.size(); ++p) pieces[p].triangles.reserve(sizes[p]);
  std::vector<bool> vertex_seen(vertex_count, false), side_seen(gluing.mate.size(), false);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
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

std::vector<BoundaryLoop> BoundaryLoops(const SurfaceMesh& mesh, std::span<const Side> sides,
                                        std::span<const std::uint32_t> component) {
  std::vector<std::uint32_t> next = Successors(mesh, sides);
  std::vector<BoundaryLoop> loops;
  for (std::uint32_t start = 0; start < next.size(); ++start) {
    if (next[start] == kNone) continue;
    BoundaryLoop& loop = loops.emplace_back();
    loop.component = component.empty() ? 0 : component[start];
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
