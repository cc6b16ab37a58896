// The seam allowance: a closed curve at a distance round a piece.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/drawing.h"
#include "core/drawing/outline.h"

namespace arap {

// What the borders of a drawing may cost together, in pairs of edges that are looked at; a crossing
// counts a thousand. Enough for half a million points, not for a scribble.
struct BorderBudget {
  std::size_t left = 200'000'000;
  std::size_t left_to_check = 200'000'000;  // what was lost
};

struct Allowance {
  std::vector<Ring> rings;  // the piece on their left; each begins at its point farthest along x
  // Length of the outline that has no allowance of its own, because that runs into the piece or into
  // the allowance of another part of it: along gaps narrower than twice the width, slits, holes that
  // vanish, hollow corners sharper than 39°. What lies within a tenth of the width of where it
  // should does not count. Empty when `left_to_check` is not enough to find it out.
  std::optional<double> lost = 0;
};

// The border of everything within `width` of the piece that `rings` bound: each ring has the piece
// on its left, so that holes shrink; of an outline that crosses itself whatever it goes round is the
// piece. No curve of the answer crosses itself or another, and a hole that is narrower vanishes.
// Exact to 2^-26 of the size. Needs width > 0 and finite coordinates. Takes about n log n and a few
// µs for each crossing of the rings, or of bends that are narrower than the width; kInvalidOption
// when `budget` has not enough for that.
Result<Allowance> OffsetOutwards(const std::vector<Ring>& rings, double width, Corners corners,
                                 BorderBudget& budget);

}  // namespace arap
