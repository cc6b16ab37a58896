// Two runs of bench_compare beside each other: what has become slower or larger.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace arap::bench {

// How much more than before a figure of ours may be: the medians of two runs on a quiet machine differ by less.
inline constexpr double kNoise = 0.1;

struct Change {
  std::string name;  // section.size.figure
  double before = 0, now = 0;
  double factor = 1;  // now / before; of durations, over what the machine has become slower
  bool regression = false;
};

struct Comparison {
  // How much slower this run's machine was: the median of what the others (the paper's scheme, CGAL) took, now over
  // before; 1 when there are none.
  double machine = 1;
  std::vector<Change>
      changes;  // of ours: durations (…_us, …_ms) and memory (…_bytes), in their order
  std::vector<std::string> missing;  // of the run before, those that this one has not

  bool regressed() const;
};

// Both as --json writes them. What only one run has measured is no change.
Comparison CompareRuns(const nlohmann::ordered_json& before, const nlohmann::ordered_json& now);

void PrintComparison(const Comparison& comparison);

}  // namespace arap::bench
