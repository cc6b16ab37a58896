// What a pattern is made of when its lines are there: the seam allowance round each piece
// (allowance.cc), notches (notches.cc), and where the pieces lie (arrange.cc).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/drawing.h"
#include "arap/model/flatten.h"
#include "core/base/plane.h"
#include "core/drawing/pattern.h"

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

// Puts a short line across both sides of every seam, in the middle of each stretch along which the
// same two sides were one, and the number of the stretch beside it, from 1. They point into the
// allowance where there is one (of `allowance` millimetres, else 0) and into the piece where there
// is none; stretches shorter than 6 mm have none. `pattern` is made of `flat` and nothing of it was
// moved. O(n log n) in the edges that were cut.
void AddNotches(const Flattening& flat, double allowance, Pattern& pattern);

// Where pieces touch with all that is drawn of them, sets all out in rows about as long as they are
// high together, `gap` apart. Else nothing moves.
void SetApart(double gap, Pattern& pattern);

// Packs the pieces into a roll that runs along x and is `width` (y) wide: in columns, the longest
// first, 5 mm apart. Pieces with a grain line keep their direction, so that grain lines stay parallel;
// the others lie along the roll or across it, whichever makes it shorter. kInvalidOption with the
// first piece that fits neither way. O(n²) for few pieces, n for many.
Status PackRoll(double width, Pattern& pattern);

}  // namespace arap
