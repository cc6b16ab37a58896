// Sides: every triangle side, in an order that brings the sides of one edge together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

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

}  // namespace arap
