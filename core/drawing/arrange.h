// Where the pieces of a pattern lie.
#pragma once

#include "arap/base/result.h"
#include "core/drawing/pattern.h"

namespace arap {

// Where pieces touch with all that is drawn of them, sets all out in rows about as long as they are
// high together, `gap` apart. Else nothing moves.
void SetApart(double gap, Pattern& pattern);

// Packs the pieces into a roll that runs along x and is `width` (y) wide: in columns, the longest
// first, 5 mm apart. Pieces with a grain line keep their direction, so that grain lines stay parallel;
// the others lie along the roll or across it, whichever makes it shorter. kInvalidOption with the
// first piece that fits neither way. O(n²) for few pieces, n for many.
Status PackRoll(double width, Pattern& pattern);

}  // namespace arap
