// One chart laid flat: its steps in order.
#pragma once

#include <string>
#include <vector>

#include "arap/core/flattener.h"
#include "core/flatten/chart.h"
#include "core/flatten/layout/chart_factors.h"
#include "core/flatten/layout/wishes.h"
#include "core/sparse/factor.h"

namespace arap {

// In units of the input, at the place that the pins say or around the anchors.
struct ChartLayout {
  std::vector<Complex> first_step, uv;  // #V
  std::vector<std::uint32_t> anchors;   // of the chart; two or none
  int refinements = 0;
  RefineEnd refine_end = RefineEnd::kNotRefined;
  std::size_t clamped = 0;   // edges whose cotangent was raised
  FactorTimes factor_times;  // of the factors made, added up
};

// `energy` is that of the options with the rigidity of the chart's own triangles. `name` tells the
// chart's factors from those of others in `cache`. Faults: kNumerical, kNotInjective, of
// `cancel`.
Result<ChartLayout> LayOutChart(const Chart& chart, const FlattenOptions& options,
                                const EnergyOptions& energy, PinSolver solver, const Wishes& wishes,
                                const std::string& name, FactorCache& cache,
                                const CancelToken& cancel);

}  // namespace arap
