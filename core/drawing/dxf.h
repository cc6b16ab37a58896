// DXF files of patterns, for cutters and CAD.
#pragma once

#include <string>

#include "core/drawing/pattern.h"

namespace arap {

// DXF of release 12 (ASCII), one drawing unit a millimetre, y up. Layers: OUTLINE and CUT (the
// allowance) with closed polylines, SEAM with open polylines along the parts of the outline that
// were cut open, GRAIN with lines. Six decimals.
std::string FormatDxf(const Pattern& pattern);

}  // namespace arap
