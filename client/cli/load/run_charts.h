// The pictures of a run.
#pragma once

#include "client/cli/load/chart.h"
#include "client/cli/load/results.h"

namespace arap::cli {

// Median, p99 and slowest response of each interval; the run has some.
Chart TimesChart(const LoadResults& results, Operation operation);
// Offered, answered and, if any, failed messages a second of each interval; the run has some.
Chart RatesChart(const LoadResults& results, Operation operation);
// Which part of the answers took how long, where each further nine of the part is as wide.
Chart QuantilesChart(const LoadResults& results, Operation operation);
// Median and p99 of the steps of a ramp or search by their rate; the run has some.
Chart StepsChart(const LoadResults& results);

}  // namespace arap::cli
