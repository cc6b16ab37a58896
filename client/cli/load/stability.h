// StabilityRule: when a run has said what there is to be said.
#pragma once

#include <array>
#include <cstddef>

namespace arap::cli {

// Stable is a run whose last kSeconds seconds each answered as many messages, with the same median of
// their response, as they did on average, within so many percent.
class StabilityRule {
 public:
  static constexpr std::size_t kSeconds = 5;

  explicit StabilityRule(double percent) : within_(percent / 100) {}

  // A second has gone by. Whether the run is stable now; a second without answers never is.
  bool Add(double answered, double median);

 private:
  using Values = std::array<double, kSeconds>;
  bool Agree(const Values& values) const;

  double within_;
  std::size_t seen_ = 0;
  Values answered_{}, medians_{};
};

}  // namespace arap::cli
