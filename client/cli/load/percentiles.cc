#include "client/cli/load/percentiles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace arap::cli {

Percentiles PercentilesOf(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const auto at = [&](double percent) {
    const double rank = std::ceil(percent / 100 * static_cast<double>(samples.size()));
    return samples[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  };
  return {at(50), at(90), at(99), samples.back()};
}

}  // namespace arap::cli
