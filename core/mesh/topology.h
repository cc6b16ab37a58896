// Topology: edges with their triangles and opposite vertices, components, boundary loops.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// Stands for "no such element".
inline constexpr std::uint32_t kNone = 0xffffffffu;

// An edge from the lower to the higher vertex. A hinge is an edge with two triangles.
struct Edge {
  std::uint32_t v0 = kNone;
  std::uint32_t v1 = kNone;
  std::array<std::uint32_t, 2> triangle{kNone,
                                        kNone};  // ascending; the second is kNone at a boundary
  std::array<std::uint32_t, 2> opposite{kNone,
                                        kNone};  // the corner of each that is not on the edge

  bool boundary() const { return triangle[1] == kNone; }
};

// Built once per mesh, then immutable. Needs a mesh whose edges have at most two triangles each.
struct Topology {
  std::vector<Edge> edges;                                   // #E, by (v0, v1)
  std::vector<std::array<std::uint32_t, 3>> triangle_edges;  // #F; entry k lies opposite corner k

  // Components: connected through vertices. Numbered by their lowest vertex.
  std::vector<std::uint32_t> vertex_component;  // #V, kNone when unreferenced
  std::size_t components = 0;

  // Pieces: connected through edges. A component of several pieces hangs together at joint
  // vertices.
  std::vector<std::uint32_t> triangle_piece;  // #F
  std::size_t pieces = 0;
  std::vector<std::uint32_t> joints;  // vertices where several pieces meet, ascending

  std::size_t boundary_loops = 0;
  std::size_t unreferenced = 0;
};

// O(#F log #F).
Topology BuildTopology(std::size_t vertex_count, std::span<const Triangle> triangles);

}  // namespace arap
