// Trend: whether a measured quantity stays where it is.
#pragma once

#include <span>

namespace arap::fault {

struct Line {
  double mean = 0;
  double slope = 0;  // per sample
};

// The straight line that fits best, by least squares. Of no samples: zero.
Line Fit(std::span<const double> samples);

// How much the fitted line rises from the first sample to the last.
double Rise(std::span<const double> samples);

// The last two thirds: what comes after warming up.
std::span<const double> AfterWarmUp(std::span<const double> samples);

}  // namespace arap::fault
