// How much a figure of two runs differs by itself.
#pragma once

#include <cstddef>
#include <optional>

#include "client/cli/load/metric.h"
#include "client/cli/load/results.h"

namespace arap::cli {

// With fewer whole intervals in a run nothing is said.
inline constexpr std::size_t kLeastIntervals = 5;

// What of a change from `a` to `b` is noise: of times and rates a part of the figure of `a`, of shares
// as they are.
//   what intervals have: three standard errors of the difference, by how the intervals of each run
//     differ. Of a median that is the median deviation, for one interval that is far off hardly moves it;
//     of the slowest the deviation of one interval.
//   other times: what the median, beyond it the p99, or where there are few the slowest of the response is
//     off by, and at least what so many times leave open by themselves.
//   losses, resumptions and wrong answers: three roots of their numbers.
//   the rate that a search has found: the resolutions of both.
// Of times it is 1.6 % at least, which is what two histograms resolve, of rates 0.2 %. Nothing where there are fewer than
// kLeastIntervals, or the figure is in neither.
std::optional<double> NoiseOf(const Metric& metric, const LoadResults& a, const LoadResults& b);

}  // namespace arap::cli
