// Validation: the one place that decides whether a mesh is acceptable, and what is repaired.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

// The largest coordinate of a planar mesh: areas are finite up to it.
inline constexpr double kMaxCoordinate = 1e150;

// A triangle is degenerate when its smallest height is below this fraction of its longest edge, or
// its longest edge is below this fraction of the bounding-box diagonal.
inline constexpr double kDegenerateRatio = 1e-9;

// Checks a mesh in place. Faults: kEmptyMesh, kMeshTooLarge, kNonFiniteCoordinate,
// kIndexOutOfRange, kRepeatedIndex, kDuplicateTriangle, kNonManifoldEdge, kNotOrientable
// (surfaces), kDegenerateTriangle; each with the first offending ids. Planar triangles that run
// clockwise are turned round; surface triangles are turned to agree with the first triangle of
// their component. Both are warned of, as are unreferenced vertices. O(#F log #F).
//
// `sides` comes with what SortedSides makes of the triangles, or empty where that is not known yet,
// and leaves with that of the turned ones.
Result<std::vector<Warning>> ValidatePlanar(PlanarMesh& mesh, const MeshLimits& limits,
                                            std::vector<Side>& sides);
Result<std::vector<Warning>> ValidatePlanar(PlanarMesh& mesh, const MeshLimits& limits);
Result<std::vector<Warning>> ValidateSurface(SurfaceMesh& mesh, const MeshLimits& limits);

// The parts of ValidateSurface in its order, for a caller that cuts before it orients.
// `sides` is what SortedSides makes of the triangles.
Status CheckArrays(const SurfaceMesh& mesh, const MeshLimits& limits);  // up to kRepeatedIndex
Status CheckArrays(const PlanarMesh& mesh, const MeshLimits& limits);
Status CheckDuplicates(std::span<const Triangle> triangles, std::span<const Side> sides);
Fault NonManifoldEdgeFault(std::span<const Side> edge);  // its three or more sides
// Ascending. Finite positions that are too far apart to be subtracted or squared count too.
std::vector<std::uint32_t> DegenerateTriangles(const SurfaceMesh& mesh);
Fault DegenerateFault(const std::vector<std::uint32_t>& degenerate);  // at least one

// Each adds a warning when there is something to warn of.
void AddWarning(std::string kind, const std::vector<std::uint32_t>& elements, std::string message,
                std::vector<Warning>& warnings);
void WarnTurned(const std::vector<bool>& turned, std::vector<Warning>& warnings);
void WarnUnreferenced(std::size_t vertices, const std::vector<Triangle>& triangles,
                      std::vector<Warning>& warnings);

}  // namespace arap
