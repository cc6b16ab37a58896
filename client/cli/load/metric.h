// The figures of a run by name, as thresholds and comparisons speak of them: "p99", "drag.queue.p50",
// "errors", "rate".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "client/cli/load/results.h"

namespace arap::cli {

enum class Unit : std::uint8_t { kMicros, kPerSecond, kCount, kShare };

// "412 µs", "1.23 ms"; "999.5/s"; "12"; "0.10 %". At most nine characters unless counts are huge.
std::string FormatFigure(double value, Unit unit);
inline std::string FormatMicros(double micros) { return FormatFigure(micros, Unit::kMicros); }

struct Metric {
  // Quantile, kMean and kMax are of times; the others count. kErrors has those of openings and calls
  // around the messages too, unless of one operation.
  enum class Kind : std::uint8_t {
    kQuantile,
    kMean,
    kMax,
    kRate,  // answered a second
    kErrors,
    kLate,
    kUnsent,
    kReplaced,
    kWrong,
    kLost,
    kResumed,  // streams that went on after a loss
    kFound,    // the highest rate that a search has found
  };
  enum class Times : std::uint8_t { kResponse, kService, kQueue, kSolve };

  std::optional<Operation> operation;  // nothing: all of them together
  Times times = Times::kResponse;
  Kind kind = Kind::kQuantile;
  double quantile = 0;  // 0 to 1
  // What counts as a part of all there could have been: of those that were answered or failed, were
  // sent, were due, were verified; of the streams.
  bool share = false;

  bool IsTime() const { return kind <= Kind::kMax; }
  bool IsRate() const { return kind == Kind::kRate || kind == Kind::kFound; }
  // Whether it is of the run alone, and not of one operation.
  bool IsOfTheRun() const { return kind >= Kind::kLost; }
  Unit unit() const;
};

// [OPERATION.][response.|service.|queue.|solve.]NAME where the name is p50, p99.9 and the like, mean,
// max, rate, errors, late, unsent, replaced, wrong, lost, resumed or found. kInvalidOption for anything else.
Result<Metric> ParseMetric(std::string_view text);
// The text that ParseMetric takes; response is left out.
std::string NameOf(const Metric& metric);

struct Part {
  std::uint64_t count = 0, of = 0;
};
// What a metric counts, and of how many; 0 of 0 of times and rates.
Part PartOf(const Metric& metric, const LoadResults& results);
// The times that a metric of times is of.
const Histogram& TimesOf(const Metric& metric, const OperationResults& done);
// Times are microseconds. Nothing where there is nothing to measure: no answer, no verified one.
std::optional<double> ValueOf(const Metric& metric, const LoadResults& results);

}  // namespace arap::cli
