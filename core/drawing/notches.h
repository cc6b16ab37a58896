// Notches: marks that pair the two sides of every seam.
#pragma once

#include "arap/model/flatten.h"
#include "core/drawing/pattern.h"

namespace arap {

// Puts a short line across both sides of every seam, in the middle of each stretch along which the
// same two sides were one, and the number of the stretch beside it, from 1. They point into the
// allowance where there is one (of `allowance` millimetres, else 0) and into the piece where there
// is none; stretches shorter than 6 mm have none. `pattern` is made of `flat` and nothing of it was
// moved. O(n log n) in the edges that were cut.
void AddNotches(const Flattening& flat, double allowance, Pattern& pattern);

}  // namespace arap
