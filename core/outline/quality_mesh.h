// Well-shaped triangles inside outlines.
#pragma once

#include <cstddef>
#include <span>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/outline.h"
#include "core/outline/asked.h"

namespace arap {

// Triangles in what lies inside an odd number of `outlines`, which may run either way: about
// `vertices` vertices (1 to kMaxAskedVertices) when that is enough, small triangles at small
// features and larger ones away from them, at most `most` vertices. No angle is below 20 degrees,
// except at corners of the outlines that are sharper, and near places that come close to one
// another. All points of the outlines are vertices.
//
// kInvalidOption: outlines that cross, touch, or have fewer than three points, by their place in
// `outlines` where one alone is at fault; or so close to one another, or with so few of the digits of
// a double for how far they are from 0, that rounding spoils their triangles. kEmptyMesh: nothing
// inside. kNonFiniteCoordinate. kLimitExceeded: more than kMaxOutlinePoints, outlines that are wound
// into one another so often that looking at them takes too long, or places so narrow that they need
// more vertices than `most`. Those of `cancel`, which is asked every few milliseconds.
Result<QualityMesh> MeshOutlines(std::span<const Outline> outlines, std::size_t vertices,
                                 std::size_t most = kMaxMeshVertices,
                                 const CancelToken& cancel = {});

}  // namespace arap
