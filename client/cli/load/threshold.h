// What is asked of a run, or of the difference of two: "p99<20ms", "errors<0.1%", "rate>1000".
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "client/cli/load/metric.h"

namespace arap::cli {

struct Threshold {
  enum class Relation : std::uint8_t { kBelow, kAtMost, kAbove, kAtLeast };

  std::string text;  // as it was said, without spaces
  Metric metric;
  Relation relation = Relation::kBelow;
  double bound = 0;  // in the unit of the metric; of a difference a part of 1

  bool MetBy(double value) const;
};

// METRIC, one of < <= > >=, and a bound: a time with its unit (us, µs, ms, s), a rate with or without
// "/s", a count or, with "%", a part of all there could be. Spaces do not count. kInvalidOption with a
// sentence that says what of it is wrong.
Result<Threshold> ParseThreshold(std::string_view text);
// Of how much a figure of one run is more than that of another; negative: less. The bound is always in
// percent: of the first figure for times and rates, "p99<5%", "rate>-2%"; percentage points for the
// others, which are parts then, "errors<0.1%".
Result<Threshold> ParseDifferenceThreshold(std::string_view text);

struct Judgement {
  Threshold threshold;
  std::optional<double> value;  // nothing: there was nothing to measure, and it is not met
  bool met = false;
  std::string shown;  // the value for people
};
std::vector<Judgement> Judge(std::span<const Threshold> thresholds, const LoadResults& results);

// Whether thresholds speak of this and all that do are met: it is not held against the run then.
bool LetPass(std::span<const Judgement> judgements, Metric::Kind kind);

// "p99<20ms  met  12.3 ms", a line for each; what is missed is red on such a terminal.
std::string FormatJudgements(std::span<const Judgement> judgements, int descriptor);
// [{"threshold": "p99<20ms", "value": 12300, "met": true}], times in microseconds and parts of 1.
nlohmann::ordered_json ToJson(std::span<const Judgement> judgements);

}  // namespace arap::cli
