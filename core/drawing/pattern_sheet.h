// The SVG of a pattern at true size.
#pragma once

#include <string>
#include <vector>

#include "core/drawing/pattern.h"

namespace arap {

struct PatternSheet {
  bool strain = true;     // colour the triangles by strain, with a legend and the caption
  bool interior = false;  // draw the edges inside
  std::vector<std::string> caption;
};

// Width, height and view box are in millimetres, so that it prints at true size. Groups by id:
// strain, interior, outline, seam, grain, allowance; each only when there is something in it.
// Places are rounded to 0.001 mm (those of strain and interior to 0.01).
std::string FormatPattern(const Pattern& pattern, const PatternSheet& sheet);

}  // namespace arap
