// Outlines made simpler, or grown outwards.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/outline.h"

namespace arap {

// What outlines may have in points when they are to grow, after they were simplified.
inline constexpr std::size_t kMaxExpandedPoints = 20'000;
// And what it may cost to unite what has grown: a second or so (CanAfford in core/outline/offset.h).
inline constexpr std::size_t kMostToExpand = 50'000'000;

// The faults of ShapeOutlines in the options, and of outlines that CheckOutlines finds.
Status CheckShaping(std::span<const Outline> outlines, const OutlineOptions& options);

struct ShapedOutlines {
  std::vector<Outline> outlines;  // in no particular order or direction when they have grown
  // Without an expansion no point of an outline is further than this from what is made of it, nor
  // the other way round. With one every point of an outline is as far as the expansion, give or take
  // this, from what the given outlines have inside.
  double error = 0;
};

// Simplified by at most `tolerance`, and grown by `expansion`: all places within it of what lies
// inside an odd number of outlines. Then pieces may run together, and holes close. Arcs are made of
// lines within the tolerance, or within a hundredth of the expansion when there is none. What neither
// is asked of stays as it is.
//
// kInvalidOption: outlines that cross, touch or have fewer than three points; a tolerance or an
// expansion that is negative, not finite or (expansion) larger than the outlines, with the field;
// what comes to touch itself when it grows; what is so close to one another that rounding spoils it.
// kNonFiniteCoordinate. kLimitExceeded: too many points, or outlines that are wound into one another,
// or cross when they grow, so often that it takes too long: found out before the work.
// Those of `cancel`, which is asked all the while, but for the second or two that uniting takes at most.
Result<ShapedOutlines> ShapeOutlines(std::span<const Outline> outlines,
                                     const OutlineOptions& options, const CancelToken& cancel = {});

// What it takes at most of outlines of so many points in all, but where they are wound.
struct ShapingCost {
  double seconds = 0;     // of processor time
  std::size_t bytes = 0;  // at the peak
};
ShapingCost EstimateShaping(std::size_t points, const OutlineOptions& options);

}  // namespace arap
