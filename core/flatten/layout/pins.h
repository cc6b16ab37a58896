// Pins and grain lines: what the caller wants of the layout, found on the charts.
#pragma once

#include <optional>
#include <vector>

#include "arap/base/result.h"
#include "arap/core/flattener.h"
#include "core/flatten/layout/held.h"
#include "core/flatten/prepared_surface.h"

namespace arap {

// What is wanted of one chart.
struct ChartWishes {
  // Pins in units of the input, by vertex. Two and more fix the layout; a single one only moves it.
  std::vector<HeldVertex> pins;
  struct Direction {
    std::uint32_t from = 0, to = 0;  // of the chart
    double angle = 0;                // radians
  };
  std::optional<Direction> grain;

  bool pinned() const { return pins.size() > 1; }
};

// One for every chart. Of a vertex that a cut doubled, the first copy on each chart is pinned; a
// grain line along a cut keeps to one side of it, and to the first chart that has none yet. Faults:
// kIndexOutOfRange, kInvalidOption (not finite or farther away than kMaxPinDistance diagonals, a
// weight out of range, a vertex pinned twice or in no triangle, several pins at one place, a grain
// line between charts or on charts that have one or that pins fix); fields "pins[i]…" and
// "grain_lines[i]…"; and what `cancel` answers on the way.
Result<std::vector<ChartWishes>> FindWishes(const PreparedSurfaceParts& surface,
                                            const FlattenOptions& options,
                                            const CancelToken& cancel = {});

}  // namespace arap
