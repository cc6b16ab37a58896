// Well-shaped triangles inside outlines.
#pragma once

#include <cstddef>
#include <span>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/outline/outline.h"

namespace arap {

// What may be asked for, and what a mesh may have when narrow places need more; besides, it has at
// most a hundred for each vertex that was asked for and each point of the outlines.
inline constexpr std::size_t kMaxAskedVertices = 1'000'000;
inline constexpr std::size_t kMaxMeshVertices = 1'500'000;

struct QualityMesh {
  // Counter-clockwise, no loose vertices, in an order that depends on the outlines alone;
  // coordinates are rounded to the ninth digit of the largest one.
  PlanarMesh mesh;
  std::size_t pieces = 0;     // connected through edges
  std::size_t holes = 0;      // of all pieces
  double smallest_angle = 0;  // degrees
};

// Triangles in what lies inside an odd number of `outlines`, which may run either way: about
// `vertices` vertices (1 to kMaxAskedVertices) when that is enough, small triangles at small
// features and larger ones away from them. No angle is below 20 degrees, except at corners of the
// outlines that are sharper, and near places that come close to one another. All points of the
// outlines are vertices.
//
// kInvalidOption: outlines that cross, share a line, or have fewer than three points. kEmptyMesh:
// nothing inside. kNonFiniteCoordinate. kLimitExceeded: more than kMaxOutlinePoints, or places so
// narrow that they need more vertices than the above. About n log n: 20 µs and half a kilobyte for
// a vertex.
Result<QualityMesh> MeshOutlines(std::span<const Outline> outlines, std::size_t vertices);

}  // namespace arap
