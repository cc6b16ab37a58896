// What the flattener needs to know of a surface before it starts.
#pragma once

#include <cstdint>

#include "core/base/result.h"
#include "core/mesh/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

// kNotADisk unless the surface is connected (through edges), with one boundary and no handles; the
// message says what it is instead.
Status CheckDisk(const Topology& topology, std::size_t vertices, std::size_t triangles);

// Index of the edge whose middle is nearest to the area centroid; the lowest where several are. The
// mesh is normalised to a unit diagonal
// [II09 §7 "an edge at the center of the mesh"].
std::uint32_t CentreEdge(const SurfaceMesh& mesh, const Topology& topology);

}  // namespace arap
