// Topology: the sides of triangles, the edges they make, components and boundary loops.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// Stands for "no such element".
inline constexpr std::uint32_t kNone = 0xffffffffu;

// A side is numbered 3·triangle + the corner that it lies opposite of, and runs from the next
// corner to the one after.
constexpr std::uint32_t NextSide(std::uint32_t side) { return side % 3 == 2 ? side - 2 : side + 1; }
constexpr std::uint32_t PreviousSide(std::uint32_t side) {
  return side % 3 == 0 ? side + 2 : side - 1;
}
inline std::uint32_t SideStart(std::span<const Triangle> triangles, std::uint32_t side) {
  return triangles[side / 3][NextSide(side) % 3];
}
inline std::uint32_t SideEnd(std::span<const Triangle> triangles, std::uint32_t side) {
  return triangles[side / 3][PreviousSide(side) % 3];
}

// One side of a triangle, whichever way it runs.
struct Side {
  std::uint32_t v0 = 0, v1 = 0;  // v0 < v1
  std::uint32_t index = 0;

  std::uint32_t triangle() const { return index / 3; }
  std::uint32_t corner() const { return index % 3; }
  bool SameEdge(const Side& other) const { return v0 == other.v0 && v1 == other.v1; }
};

// All 3·#F sides by (v0, v1, triangle); the vertices of every triangle must differ and be below
// `vertex_count`. O(#V + #F log(most triangles at a vertex)).
std::vector<Side> SortedSides(std::size_t vertex_count, std::span<const Triangle> triangles);

// Calls `visit` with the sides of one edge at a time, a span into `sides`.
template <class Visit>
void ForEachEdge(std::span<const Side> sides, Visit visit) {
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].SameEdge(sides[begin])) ++end;
    visit(sides.subspan(begin, end - begin));
  }
}

// An edge from the lower to the higher vertex. A hinge is an edge with two triangles.
struct Edge {
  std::uint32_t v0 = kNone;
  std::uint32_t v1 = kNone;
  // Its triangles, ascending; the second is kNone at a boundary.
  std::array<std::uint32_t, 2> triangle{kNone, kNone};
  // The corner of each that is not on the edge.
  std::array<std::uint32_t, 2> opposite{kNone, kNone};

  bool boundary() const { return triangle[1] == kNone; }
};

// Built once per mesh, then immutable. Needs a mesh whose edges have at most two triangles each.
struct Topology {
  std::vector<Edge> edges;                                   // #E, by (v0, v1)
  std::vector<std::array<std::uint32_t, 3>> triangle_edges;  // #F; entry k lies opposite corner k

  // Components: connected through vertices. Numbered by their lowest vertex.
  std::vector<std::uint32_t> vertex_component;  // #V, kNone when unreferenced
  std::size_t components = 0;

  // Pieces: connected through edges. Several pieces of one component meet in joint vertices.
  std::vector<std::uint32_t> triangle_piece;  // #F
  std::size_t pieces = 0;
  std::vector<std::uint32_t> joints;  // vertices where several pieces meet, ascending

  std::size_t boundary_loops = 0;
  std::size_t unreferenced = 0;
};

// The sides again, after the corners 1 and 2 of `turned` triangles (#F) have changed places.
void TurnSides(const std::vector<bool>& turned, std::vector<Side>& sides);

// O(#F log #F).
Topology BuildTopology(std::size_t vertex_count, std::span<const Triangle> triangles);
// The same for who has the sides already: what SortedSides makes of the triangles.
Topology BuildTopology(std::size_t vertex_count, std::span<const Triangle> triangles,
                       std::span<const Side> sides);

// Disjoint sets of 0…n−1, with numbers in order of their lowest member.
class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t Find(std::uint32_t x) {
    while (parent_[x] != x) {
      parent_[x] = parent_[parent_[x]];
      x = parent_[x];
    }
    return x;
  }

  // The lower root wins, so that a root is the lowest member of its set.
  void Join(std::uint32_t a, std::uint32_t b) {
    a = Find(a);
    b = Find(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace arap
