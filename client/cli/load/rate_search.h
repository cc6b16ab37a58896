// RateSearch: which rate to try next, to find the highest one at which a server does what is asked of
// it.
#pragma once

#include <optional>

namespace arap::cli {

// Doubles the rate from the first one until it is not met, or halves it until it is; then tries the
// geometric mean of the highest that was met and the lowest above it that was not, until they are
// within `resolution` of each other. A server that meets a rate is expected to meet all below it.
class RateSearch {
 public:
  static constexpr double kLowest = 0.1, kHighest = 1e6;  // a second

  // `resolution`: 0.05 finds the rate to 5 %.
  RateSearch(double first, double resolution) : resolution_(resolution), next_(first) {}

  // The rate to try; nothing when all is known.
  std::optional<double> next() const { return next_; }
  // That rate was tried.
  void Tried(bool met);

  // The highest rate that was met so far.
  std::optional<double> found() const { return met_; }

 private:
  double resolution_;
  std::optional<double> next_, met_, missed_;
};

}  // namespace arap::cli
