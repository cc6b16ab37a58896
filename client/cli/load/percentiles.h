// Percentiles of samples.
#pragma once

#include <vector>

namespace arap::cli {

struct Percentiles {
  double p50 = 0, p90 = 0, p99 = 0, max = 0;
};

// Exact: the smallest sample that so many percent do not exceed. Zeros without samples.
Percentiles PercentilesOf(std::vector<double> samples);

}  // namespace arap::cli
