#include "client/cli/load/metric.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace arap::cli {
namespace {

using Kind = Metric::Kind;

constexpr std::array<std::string_view, 4> kTimesNames{"response", "service", "queue", "solve"};
constexpr std::array<std::pair<std::string_view, Kind>, 11> kKindNames{
    {{"mean", Kind::kMean},
     {"max", Kind::kMax},
     {"rate", Kind::kRate},
     {"errors", Kind::kErrors},
     {"late", Kind::kLate},
     {"unsent", Kind::kUnsent},
     {"replaced", Kind::kReplaced},
     {"wrong", Kind::kWrong},
     {"lost", Kind::kLost},
     {"resumed", Kind::kResumed},
     {"found", Kind::kFound}}};

tl::unexpected<Fault> UnknownMetric(std::string_view text) {
  return Fail(
      FaultKind::kInvalidOption,
      fmt::format(
          "'{}' is no figure: those are p50, p99.9 and the like, mean, max, rate, "
          "errors, late, unsent, replaced, wrong, lost, resumed and found, of one operation "
          "as drag.p99, of the server's times as queue.p99 or solve.p99",
          text));
}

// Three digits.
std::string ThreeDigits(double value) {
  return value < 9.995   ? fmt::format("{:.2f}", value)
         : value < 99.95 ? fmt::format("{:.1f}", value)
                         : fmt::format("{:.0f}", value);
}

OperationResults DoneOf(const Metric& metric, const LoadResults& results) {
  return metric.operation ? results.operations[*metric.operation] : results.Total();
}

}  // namespace

std::string FormatFigure(double value, Unit unit) {
  switch (unit) {
    case Unit::kMicros:
      if (value < 999.5) return ThreeDigits(value) + " µs";
      if (value < 999'500) return ThreeDigits(value / 1000) + " ms";
      return ThreeDigits(value / 1e6) + " s";
    case Unit::kPerSecond:
      return fmt::format("{:.1f}/s", value);
    case Unit::kCount:
      return fmt::format("{:.0f}", value);
    case Unit::kShare:
      // A single one of many must not look like none.
      if (value > 0 && value < 0.00005) return "<0.01 %";
      return fmt::format("{:.2f} %", 100 * value);
  }
  return {};
}

Unit Metric::unit() const {
  if (IsTime()) return Unit::kMicros;
  if (IsRate()) return Unit::kPerSecond;
  return share ? Unit::kShare : Unit::kCount;
}

Result<Metric> ParseMetric(std::string_view text) {
  Metric metric;
  std::string_view rest = text;
  const auto take = [&rest](const auto& names) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!rest.starts_with(names[i]) || rest.substr(names[i].size(), 1) != ".") continue;
      rest.remove_prefix(names[i].size() + 1);
      return i;
    }
    return std::nullopt;
  };
  if (const auto operation = take(kOperationNames)) {
    metric.operation = static_cast<Operation>(*operation);
  }
  const auto times = take(kTimesNames);
  if (times) metric.times = static_cast<Metric::Times>(*times);
  if (rest.starts_with('p')) {
    const char* const end = rest.data() + rest.size();
    double percent = 0;
    const auto [stop, error] =
        std::from_chars(rest.data() + 1, end, percent, std::chars_format::fixed);
    if (error != std::errc() || stop != end || !(percent >= 0 && percent <= 100)) {
      return UnknownMetric(text);
    }
    metric.quantile = percent / 100;
    return metric;
  }
  const auto named = std::find_if(kKindNames.begin(), kKindNames.end(),
                                  [&](const auto& kind) { return kind.first == rest; });
  if (named == kKindNames.end()) return UnknownMetric(text);
  metric.kind = named->second;
  if (times && !metric.IsTime()) {
    return Fail(FaultKind::kInvalidOption,
                fmt::format("'{}' is no figure: {} is a count and no time", text, rest));
  }
  if (metric.operation && metric.IsOfTheRun()) {
    return Fail(FaultKind::kInvalidOption,
                fmt::format("'{}' is no figure: {} is of all operations", text, rest));
  }
  return metric;
}

std::string NameOf(const Metric& metric) {
  std::string name;
  if (metric.operation) name.append(NameOf(*metric.operation)).append(".");
  if (metric.times != Metric::Times::kResponse) {
    name.append(kTimesNames[static_cast<std::size_t>(metric.times)]).append(".");
  }
  // Twelve digits, so that 99.9 is not 99.90000000000001.
  if (metric.kind == Kind::kQuantile) return name + fmt::format("p{:.12g}", 100 * metric.quantile);
  for (const auto& [text, kind] : kKindNames) {
    if (kind == metric.kind) name += text;
  }
  return name;
}

Part PartOf(const Metric& metric, const LoadResults& results) {
  const OperationResults done = DoneOf(metric, results);
  switch (metric.kind) {
    case Kind::kErrors: {
      std::uint64_t failed = done.failed;
      if (!metric.operation) {
        std::uint64_t errors = 0;
        for (const LoadError& error : results.errors) errors += error.count;
        failed = std::max(failed, errors);
      }
      return {failed, done.answered + failed};
    }
    case Kind::kLate:
      return {done.late, done.sent};
    case Kind::kUnsent:
      return {done.unsent, done.sent + done.unsent};
    case Kind::kReplaced:
      return {done.replaced, done.sent};
    case Kind::kWrong:
      return {done.wrong, done.verified};
    case Kind::kLost:
      return {results.frames_lost, done.sent};
    case Kind::kResumed:
      return {results.resumptions, results.streams};
    default:
      return {};
  }
}

const Histogram& TimesOf(const Metric& metric, const OperationResults& done) {
  switch (metric.times) {
    case Metric::Times::kResponse:
      return done.response;
    case Metric::Times::kService:
      return done.service;
    case Metric::Times::kQueue:
      return done.queue;
    case Metric::Times::kSolve:
      return done.solve;
  }
  return done.response;
}

std::optional<double> ValueOf(const Metric& metric, const LoadResults& results) {
  if (metric.kind == Kind::kFound) return results.rate_found;
  const OperationResults done = DoneOf(metric, results);
  if (metric.IsTime()) {
    const Histogram& times = TimesOf(metric, done);
    if (times.Count() == 0) return std::nullopt;
    if (metric.kind == Kind::kMean) return times.Mean();
    return metric.kind == Kind::kMax ? times.Max() : times.Quantile(metric.quantile);
  }
  if (metric.kind == Kind::kRate) return results.PerSecond(done.answered);
  const Part part = PartOf(metric, results);
  if (part.of == 0) return std::nullopt;
  if (!metric.share) return static_cast<double>(part.count);
  return static_cast<double>(part.count) / static_cast<double>(part.of);
}

}  // namespace arap::cli
