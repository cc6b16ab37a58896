#include "core/flatten/sheet/placement.h"

#include <algorithm>
#include <limits>

#include "core/flatten/sheet/pack.h"

namespace arap {
void PlaceCharts(std::span<const ChartWishes> wishes, std::span<const std::uint32_t> chart,
                 std::vector<Complex>& uv, std::vector<Complex>& first_step) {
  if (wishes.size() < 2) return;
  std::vector<std::vector<Complex>> points(wishes.size());
  for (std::size_t v = 0; v < chart.size(); ++v) {
    if (chart[v] != kNone) points[chart[v]].push_back(uv[v]);
  }
  // Pinned charts keep their place and the sheet of the others begins right of them.
  double right = -std::numeric_limits<double>::infinity(), low = 0;
  std::vector<Complex> turns(wishes.size(), 1);
  std::size_t free_charts = 0;
  for (std::uint32_t c = 0; c < wishes.size(); ++c) {
    if (wishes[c].pins.empty()) {
      ++free_charts;
      if (wishes[c].grain) continue;
      turns[c] = UprightTurn(std::move(points[c]));
      continue;
    }
    for (const Complex p : points[c]) {
      if (p.real() > right) right = p.real(), low = p.imag();
    }
  }
  std::vector<std::uint32_t> free(chart.size(), kNone);
  for (std::size_t v = 0; v < chart.size(); ++v) {
    if (chart[v] == kNone || !wishes[chart[v]].pins.empty()) continue;
    free[v] = chart[v];
    uv[v] *= turns[chart[v]];
    first_step[v] *= turns[chart[v]];
  }
  const auto motions = PackCharts(uv, free, {.gap = 0.05, .rotate = false});
  for (std::size_t v = 0; v < free.size(); ++v) {
    if (free[v] == kNone) continue;
    first_step[v] = motions[free[v]].rotation * first_step[v] + motions[free[v]].shift;
  }
  if (free_charts == wishes.size() || free_charts == 0) return;
  // Beside the pinned ones, a twentieth of the sheet away.
  double left = std::numeric_limits<double>::infinity(), far = -left;
  for (std::size_t v = 0; v < free.size(); ++v) {
    if (free[v] == kNone) continue;
    left = std::min(left, uv[v].real());
    far = std::max(far, uv[v].real());
  }
  const Complex shift(right - left + 0.05 * (far - left), low);
  for (std::size_t v = 0; v < free.size(); ++v) {
    if (free[v] == kNone) continue;
    uv[v] += shift;
    first_step[v] += shift;
  }
}

}  // namespace arap
