// Outlines: closed curves that bound a region of the plane, traced from the pixels of an image and
// simplified to a stated error.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/outline.h"
#include "core/outline/coverage.h"

namespace arap {

// Half of what Green's formula adds up: positive for a piece, negative for a hole.
double SignedArea(const Outline& outline);

// The outlines of what is inside, in pixels of the image without its margin, y up from its lower
// border; pieces run counter-clockwise, holes clockwise. They run between the centres of
// neighbouring pixels where the value between them would be that of the threshold, and on the
// border of the image where it ends; so each is simple and none touches another. O(pixels).
// kLimitExceeded beyond kMaxOutlinePoints.
Result<std::vector<Outline>> TraceOutlines(const Coverage& coverage);

// Of processor time, for a point.
inline constexpr double kSecondsToSimplify = 30e-6;

// The same outlines with fewer points, all of them points of the given ones: no point of an outline
// is further than `tolerance` from what is made of it, nor the other way round, and none crosses or
// touches itself or another. Needs finite coordinates and three points in each. About n log n, and
// half a kilobyte for a point. kInvalidOption: outlines that cross or touch, or are so close to one
// another that rounding spoils it. kLimitExceeded: outlines that are wound into one another so often
// that it takes too long. Those of `cancel`, which is asked every few milliseconds.
Result<std::vector<Outline>> SimplifyOutlines(std::span<const Outline> outlines, double tolerance,
                                              const CancelToken& cancel = {});

}  // namespace arap
