// The sheet: several charts at true size laid side by side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"
#include "core/flatten/layout/wishes.h"
#include "core/mesh/topology.h"

namespace arap {

struct PackOptions {
  // Space between charts, as a fraction of the mean side of their bounding boxes (all widths and
  // heights alike). 0 or more, finite.
  double gap = 0.05;
  // Turn every chart onto the smallest rectangle around it, the long side along x. Off for charts
  // whose direction means something (a grain line).
  bool rotate = true;
};

// What became of a chart: p ↦ rotation·p + shift, |rotation| = 1.
struct Motion {
  Complex rotation{1};
  Complex shift{0};
};

// Moves charts, in place, so that their bounding boxes keep the gap from one another: on shelves
// from the lowest corner (0, 0) up, each filled from left to right, the highest charts first and of
// equal ones that of the lower number. The length of the shelves is the one of several tried that
// makes the sheet most nearly square. Charts are only turned and moved, never mirrored or scaled. A
// single chart stays exactly where it is.
//
// `chart` (#V) names the chart of every vertex, or kNone for those that belong to none and stay.
// Answers the motions by chart number; numbers without vertices take no room and are not moved.
// `uv` must be finite. O(#V log #V). Deterministic, thread-safe.
std::vector<Motion> PackCharts(std::span<Complex> uv, std::span<const std::uint32_t> chart,
                               const PackOptions& options = {});

// The turn (unit length, by at most 90°) that brings the smallest rectangle around `points` upright
// with its long side along x; 1 where they already lie so. O(n log n).
Complex UprightTurn(std::vector<Complex> points);

// Moves whole charts of `uv` (and of `first_step` alike) so that no bounding boxes overlap: charts
// with pins stay, the others are packed next to them. All are turned upright, those with a single
// pin about it, but not where several pins or a grain line say how they lie. Without pins the sheet
// begins at (0, 0), also that of a single chart. `chart` (#U) is the chart of each flat position, or
// kNone.
void PlaceCharts(std::span<const Wishes> wishes, std::span<const std::uint32_t> chart,
                 std::vector<Complex>& uv, std::vector<Complex>& first_step);

}  // namespace arap
