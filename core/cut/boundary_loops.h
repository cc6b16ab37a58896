// Boundary loops in order, for outlines.
#pragma once

#include <cstdint>
#include <vector>

#include "arap/model/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

struct BoundaryLoop {
  std::uint32_t component = 0;          // Topology::vertex_component
  double length = 0;                    // unit of the mesh
  std::vector<std::uint32_t> vertices;  // as its triangles run, from the lowest vertex
};

// By component; the longest loop of a component comes first (of several as long up to rounding that
// with the lowest vertex), the others follow by their lowest vertex. Of a flat, upright chart the
// outline runs counter-clockwise and holes clockwise. The triangles must agree and no two parts may
// touch in a vertex only, as CutToCharts leaves them. O(#F).
std::vector<BoundaryLoop> BoundaryLoops(const SurfaceMesh& mesh, const Topology& topology);

}  // namespace arap
