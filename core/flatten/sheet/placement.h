// Placement: the charts of a layout brought side by side.
#pragma once

#include <span>
#include <vector>

#include "core/flatten/layout/pins.h"

namespace arap {

// Moves whole charts of `uv` (and of `first_step` alike) so that no bounding boxes overlap: charts
// with pins stay, the others are packed next to them, turned upright unless a grain line says how
// they lie. A single chart stays where it is. `chart` (#U) is the chart of each flat position, or
// kNone.
void PlaceCharts(std::span<const ChartWishes> wishes, std::span<const std::uint32_t> chart,
                 std::vector<Complex>& uv, std::vector<Complex>& first_step);

}  // namespace arap
