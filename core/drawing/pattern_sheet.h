// The SVG of a pattern at true size.
#pragma once

#include <string>
#include <vector>

#include "core/drawing/pattern.h"

namespace arap {

struct PatternSheet {
  // Colour the triangles by strain, with a ground, a legend and the caption. Without it there is
  // nothing besides the lines, and no names.
  bool strain = true;
  bool interior = false;  // draw the edges inside
  std::vector<std::string> caption;
};

// Width, height and view box are in millimetres, so that it prints at true size. Groups by id:
// strain, interior, outline, seam, grain, allowance, notch, label; each only when there is something in it.
// Places are rounded to DigitsFor the pattern, 0.001 mm unless it is small (those of strain and
// interior to a digit less).
std::string FormatPattern(const Pattern& pattern, const PatternSheet& sheet);

}  // namespace arap
