// Pins and grain lines: what the caller wants of the layout, found on the charts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/flatten.h"
#include "core/flatten/chart.h"
#include "core/flatten/layout/held.h"

namespace arap {

// What is wanted of one chart.
struct Wishes {
  // Pins in units of the input, by vertex. Two and more fix the layout; a single one only moves it.
  std::vector<HeldVertex> pins;
  struct Direction {
    std::uint32_t from = 0, to = 0;  // of the chart
    double angle = 0;                // radians
  };
  std::optional<Direction> grain;

  bool pinned() const { return pins.size() > 1; }
};

// One for every chart. The options have passed CheckFlattenOptions; `source` (#U) is the input
// vertex of each vertex of the cut surface, the first `input_vertices` in order. Of a vertex that a
// cut doubled, the first copy on each chart is pinned; a grain line along a cut keeps to one side
// of it, and to the first chart that has none yet. Faults: kIndexOutOfRange, kInvalidOption
// (farther away than kMaxPinDistance diagonals, a vertex pinned twice or in no triangle, several
// pins at one place, a grain line between charts or on charts that have one or that pins fix);
// fields "pins[i]…" and "grain_lines[i]…"; and what `cancel` answers on the way.
Result<std::vector<Wishes>> FindWishes(const std::vector<Chart>& charts,
                                       std::span<const std::uint32_t> source,
                                       std::size_t input_vertices, const FlattenOptions& options,
                                       const CancelToken& cancel = {});

}  // namespace arap
