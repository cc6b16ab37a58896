#include "client/cli/load/stability.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace arap::cli {

bool StabilityRule::Agree(const Values& values) const {
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(kSeconds);
  return mean > 0 && std::all_of(values.begin(), values.end(), [&](double value) {
           return std::abs(value - mean) <= within_ * mean;
         });
}

bool StabilityRule::Add(double answered, double median) {
  answered_[seen_ % kSeconds] = answered;
  medians_[seen_ % kSeconds] = median;
  ++seen_;
  return seen_ >= kSeconds && Agree(answered_) && Agree(medians_);
}

}  // namespace arap::cli
