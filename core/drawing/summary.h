// What people are told of a layout and of its drawing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/drawing/pattern.h"

namespace arap {

// A few lines: counts, distortion, cuts, the sizes of the pieces and of the sheet in millimetres.
// What goes under the colours of an SVG.
std::vector<std::string> Summary(const Flattening& flat, const Pattern& pattern);

// "unlikely_size": pieces shorter than 5 mm or longer than 10 m, which another unit would make
// likelier. `option` is what says the unit.
std::vector<Warning> SizeWarnings(const Pattern& pattern, std::string_view option);

}  // namespace arap
