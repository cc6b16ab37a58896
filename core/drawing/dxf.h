// DXF files of patterns, for cutters and CAD.
#pragma once

#include <string>
#include <string_view>

#include "core/drawing/pattern.h"

namespace arap {

// DXF of release 2000 (ASCII), the first that says its unit: millimetres ($INSUNITS 4,
// $MEASUREMENT 1), y up. Layers: OUTLINE and SEAM with polylines, closed where they are, CUT (the
// allowance) with closed ones, GRAIN and NOTCH with lines, LABEL with texts. Three digits more than
// DigitsFor the pattern.
std::string FormatDxf(const Pattern& pattern);

// Whether the format has all characters of a text: those of the basic plane of Unicode. Others are
// question marks.
bool DxfShows(std::string_view text);

}  // namespace arap
