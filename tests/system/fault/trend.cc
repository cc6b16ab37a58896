#include "tests/system/fault/trend.h"

namespace arap::fault {

Line Fit(std::span<const double> samples) {
  Line line;
  if (samples.empty()) return line;
  const auto count = static_cast<double>(samples.size());
  for (const double sample : samples) line.mean += sample / count;
  double moment = 0, spread = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double x = static_cast<double>(i) - (count - 1) / 2;
    moment += x * (samples[i] - line.mean);
    spread += x * x;
  }
  if (spread > 0) line.slope = moment / spread;
  return line;
}

double Rise(std::span<const double> samples) {
  if (samples.empty()) return 0;
  return Fit(samples).slope * static_cast<double>(samples.size() - 1);
}

std::span<const double> AfterWarmUp(std::span<const double> samples) {
  return samples.subspan(samples.size() / 3);
}

}  // namespace arap::fault
