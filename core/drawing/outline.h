// Curves of the plane: the box round them, and closed ones moved outwards (the seam allowance).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

// The smallest box round everything that it was shown.
struct Bounds {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
  bool empty = true;

  // A point that is not finite is passed over.
  void Add(Complex point);
  void Add(std::span<const Complex> points);
  Bounds Moved(Complex by) const;
  double width() const { return max_x - min_x; }
  double height() const { return max_y - min_y; }
};

// A closed curve; the first point is not repeated.
using Ring = std::vector<Complex>;

// What the borders of a drawing may cost together, in pairs of edges that are looked at; a crossing
// counts a thousand. Enough for a million points, not for a scribble.
struct BorderBudget {
  std::size_t left = 200'000'000;
};

// The border of everything within `width` of the piece that `rings` bound: each ring has the piece
// on its left, so that holes shrink. Corners are mitred, sharp ones cut off at twice the width; no
// curve of the answer crosses itself or another, and a hole that is narrower vanishes. Exact to
// 1/1000 of a unit (to 2^-29 of the size of large pieces). Needs width > 0 and finite coordinates.
// Takes about n log n and 30 µs for each crossing of the rings, or of bends that are narrower than
// the width; kInvalidOption when `budget` has not enough for that.
Result<std::vector<Ring>> OffsetOutwards(const std::vector<Ring>& rings, double width,
                                         BorderBudget& budget);

}  // namespace arap
