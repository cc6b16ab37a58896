// Two runs side by side: what has changed, and whether more than it changes by itself.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "client/cli/load/results.h"
#include "client/cli/load/threshold.h"

namespace arap::cli {

struct LoadDifference {
  Metric metric;
  std::optional<double> a, b;  // nothing where a run has no such figure
  // Of times and rates a part of `a`; of shares b - a. Nothing where either is missing.
  std::optional<double> change;
  // What of a change is noise, in the terms of `change`: three standard errors of the difference, by how
  // the intervals of each run differ. Of a median that is the median deviation, for one interval that is
  // far off hardly moves it; of a p99, a rate and a share the standard deviation. Of times it is 1.6 % at
  // least, which is what histograms resolve. Nothing where a run has fewer than kLeastIntervals, or
  // intervals do not have the figure.
  std::optional<double> noise;

  static constexpr std::size_t kLeastIntervals = 5;

  bool BeyondNoise() const;
  bool Worse() const;  // slower, fewer answers, more errors; by however little
};

// Response p50, p90, p99, p99.9, max and mean, queue and solve p99, rate, errors and late of each operation
// that either run has.
std::vector<LoadDifference> Compare(const LoadResults& a, const LoadResults& b);

// Thresholds of ParseDifferenceThreshold.
std::vector<Judgement> JudgeDifference(std::span<const Threshold> thresholds, const LoadResults& a,
                                       const LoadResults& b);

// A run and what it is called.
struct NamedResults {
  std::string name;
  const LoadResults& results;
};
// At most 80 columns unless names are long; says which settings differ.
std::string CompareText(const NamedResults& a, const NamedResults& b,
                        std::span<const Judgement> judgements, int descriptor);
nlohmann::ordered_json CompareJson(const NamedResults& a, const NamedResults& b,
                                   std::span<const Judgement> judgements);

}  // namespace arap::cli
