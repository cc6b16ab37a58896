// Well-shaped triangles inside outlines.
#pragma once

#include <cstddef>
#include <span>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/outline.h"

namespace arap {

// What may be asked for, and what a mesh may have when narrow places need more; besides, it has at
// most a hundred for each vertex that was asked for and each point of the outlines.
inline constexpr std::size_t kMaxAskedVertices = 1'000'000;
inline constexpr std::size_t kMaxMeshVertices = 1'500'000;

// Triangles in what lies inside an odd number of `outlines`, which may run either way: about
// `vertices` vertices (1 to kMaxAskedVertices) when that is enough, small triangles at small
// features and larger ones away from them, at most `most` vertices. No angle is below 20 degrees,
// except at corners of the outlines that are sharper, and near places that come close to one
// another. All points of the outlines are vertices.
//
// kInvalidOption: outlines that cross, touch, or have fewer than three points, by their place in
// `outlines` where one alone is at fault. kEmptyMesh: nothing inside. kNonFiniteCoordinate.
// kLimitExceeded: more than kMaxOutlinePoints, outlines that are wound into one another so often
// that looking at them takes too long, or places so narrow that they need more vertices than
// `most`. Those of `cancel`, which is asked every few milliseconds.
Result<QualityMesh> MeshOutlines(std::span<const Outline> outlines, std::size_t vertices,
                                 std::size_t most = kMaxMeshVertices,
                                 const CancelToken& cancel = {});

// What that takes at most with outlines of so many points in all, but where they are narrow.
struct MeshingCost {
  double seconds = 0;     // of processor time
  std::size_t bytes = 0;  // at the peak
};
MeshingCost EstimateMeshing(std::size_t points, std::size_t vertices, std::size_t most);

}  // namespace arap
