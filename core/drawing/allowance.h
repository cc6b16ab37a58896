// Seam allowance: the outline of a piece, moved outwards.
#pragma once

#include <vector>

namespace arap::cli {

// A closed curve x y x y…; the first point is not repeated.
using Ring = std::vector<double>;

// The border of everything within `width` of the piece that `rings` bound: each ring has the piece
// on its left, so that holes shrink. Corners are mitred, sharp ones cut off at twice the width; no
// curve of the answer crosses itself or another, and a hole that is narrower vanishes. Exact to
// 1/1000 of a unit (to 2^-29 of the size of large pieces). Needs width > 0 and finite coordinates.
std::vector<Ring> OffsetOutwards(const std::vector<Ring>& rings, double width);

}  // namespace arap::cli
