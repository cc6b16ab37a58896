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
  std::optional<double> noise;  // what of `change` is, in its terms (noise.h)

  bool BeyondNoise() const;
  bool Worse() const;  // slower, fewer answers, more errors; by however little
};

// Every figure of which less, or of rates more, is better: of each operation that either run has rate,
// response, service, queue and solve, errors, late, unsent, replaced and wrong; of the run errors, lost,
// resumed and the rate that a search has found.
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
