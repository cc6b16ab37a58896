#include "client/cli/load/noise.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace arap::cli {
namespace {

constexpr double kResolved = 0.016;  // of a time, by two histograms
// Of a rate: when the last answer of a run came is chance.
constexpr double kRateResolved = 0.002;

std::optional<double> PartIn(std::uint64_t count, std::uint64_t of) {
  if (of == 0) return std::nullopt;
  return static_cast<double>(count) / static_cast<double>(of);
}

// The figure in an interval; nothing where it has none.
std::optional<double> ValueIn(const Metric& metric, const Interval& interval) {
  const IntervalOperation& done = interval.operations[*metric.operation];
  switch (metric.kind) {
    case Metric::Kind::kRate:
      return static_cast<double>(done.answered) / interval.seconds;
    case Metric::Kind::kErrors:
      return PartIn(done.failed, done.answered + done.failed);
    case Metric::Kind::kLate:
      return PartIn(done.late, done.offered - std::min(done.unsent, done.offered));
    case Metric::Kind::kUnsent:
      return PartIn(done.unsent, done.offered);
    case Metric::Kind::kReplaced:
      return PartIn(done.replaced, done.offered - std::min(done.unsent, done.offered));
    case Metric::Kind::kQuantile:
      if (done.answered > 0 && metric.quantile == 0.5) return done.p50;
      if (done.answered > 0 && metric.quantile == 0.99) return done.p99;
      return std::nullopt;
    case Metric::Kind::kMax:
      return done.answered > 0 ? std::optional(done.max) : std::nullopt;
    default:
      return std::nullopt;
  }
}

// The figure in each whole interval where there is one. Nothing for figures that intervals do not have.
std::vector<double> ByInterval(const Metric& metric, const LoadResults& results) {
  std::vector<double> values;
  if (results.intervals.empty() || metric.times != Metric::Times::kResponse) return values;
  const double length = results.intervals.front().seconds;
  for (const Interval& interval : results.intervals) {
    if (interval.seconds < length) continue;
    if (const auto value = ValueIn(metric, interval)) values.push_back(*value);
  }
  return values;
}

// Whether the intervals have what was counted: those of an older arapctl do not have everything.
bool IntervalsHave(const Metric& metric, const LoadResults& results) {
  const OperationResults& done = results.operations[*metric.operation];
  IntervalOperation sum;
  for (const Interval& interval : results.intervals) {
    const IntervalOperation& part = interval.operations[*metric.operation];
    sum.late += part.late;
    sum.unsent += part.unsent;
    sum.replaced += part.replaced;
  }
  switch (metric.kind) {
    case Metric::Kind::kLate:
      return sum.late == done.late;
    case Metric::Kind::kUnsent:
      return sum.unsent == done.unsent;
    case Metric::Kind::kReplaced:
      return sum.replaced == done.replaced;
    default:
      return true;
  }
}

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Spread {
  double center = 0;
  double variance = 0;  // of the center, not of a value
};

// Mean and standard error: one interval that is far off moves a rate, a share and a p99 of the run.
Spread SpreadOfMean(const std::vector<double>& values) {
  const auto count = static_cast<double>(values.size());
  Spread spread;
  for (const double value : values) spread.center += value / count;
  for (const double value : values) {
    spread.variance += (value - spread.center) * (value - spread.center) / (count - 1) / count;
  }
  return spread;
}

// Median and its standard error by the median deviation: one interval hardly moves the median of a run.
Spread SpreadOfMedian(const std::vector<double>& values) {
  Spread spread{MedianOf(values), 0};
  std::vector<double> deviations;
  deviations.reserve(values.size());
  for (const double value : values) deviations.push_back(std::abs(value - spread.center));
  // Both factors are those of the normal distribution.
  const double error = 1.2533 * 1.4826 * MedianOf(std::move(deviations));
  spread.variance = error * error / static_cast<double>(values.size());
  return spread;
}

// Of a figure that intervals have.
std::optional<double> NoiseByIntervals(const Metric& metric, const LoadResults& a,
                                       const LoadResults& b) {
  const std::vector<double> in_a = ByInterval(metric, a), in_b = ByInterval(metric, b);
  if (std::min(in_a.size(), in_b.size()) < kLeastIntervals) return std::nullopt;
  if (!IntervalsHave(metric, a) || !IntervalsHave(metric, b)) return std::nullopt;
  const bool median = metric.kind == Metric::Kind::kQuantile && metric.quantile == 0.5;
  Spread of_a = median ? SpreadOfMedian(in_a) : SpreadOfMean(in_a);
  Spread of_b = median ? SpreadOfMedian(in_b) : SpreadOfMean(in_b);
  if (metric.kind == Metric::Kind::kMax) {
    // One interval makes it, and not the mean of all.
    of_a.variance *= static_cast<double>(in_a.size());
    of_b.variance *= static_cast<double>(in_b.size());
  }
  const double noise = 3 * std::sqrt(of_a.variance + of_b.variance);
  if (metric.share) return noise;
  if (of_a.center <= 0) return std::nullopt;
  return std::max(noise / of_a.center, metric.IsTime() ? kResolved : kRateResolved);
}

// Three standard errors of the rank of a quantile, as a part of so many values.
double RanksAround(double quantile, double count) {
  return 3 * std::sqrt(quantile * (1 - quantile) / count);
}

// Whether there are so few beyond a quantile that it is as good as the slowest.
bool IsOfTheSlowest(const Metric& metric, const Histogram& times) {
  if (metric.kind != Metric::Kind::kQuantile || times.Count() == 0) return false;
  return metric.quantile + RanksAround(metric.quantile, static_cast<double>(times.Count())) > 1;
}

// What so many times leave open, in three standard errors: of a quantile by the ranks around it.
double LeftOpen(const Metric& metric, const Histogram& times) {
  const auto count = static_cast<double>(times.Count());
  if (count == 0) return 0;
  if (metric.kind == Metric::Kind::kQuantile) {
    const double ranks = RanksAround(metric.quantile, count);
    return (times.Quantile(std::min(metric.quantile + ranks, 1.0)) -
            times.Quantile(std::max(metric.quantile - ranks, 0.0))) /
           2;
  }
  double variance = 0;
  for (const Histogram::Bucket& bucket : times.Buckets()) {
    const double off = (bucket.low + bucket.high) / 2 - times.Mean();
    variance += static_cast<double>(bucket.count) * off * off / count;
  }
  return 3 * std::sqrt(variance / count);
}

// Of times that intervals do not have: as much as the median, beyond it the p99, or where there are few the
// slowest, of the response is off, and what so many times leave open.
std::optional<double> NoiseOfTimes(const Metric& metric, const LoadResults& a,
                                   const LoadResults& b) {
  const Histogram& in_a = TimesOf(metric, a.operations[*metric.operation]);
  const Histogram& in_b = TimesOf(metric, b.operations[*metric.operation]);
  Metric near;
  near.operation = metric.operation;
  if (IsOfTheSlowest(metric, in_a) || IsOfTheSlowest(metric, in_b)) near.kind = Metric::Kind::kMax;
  near.quantile = metric.kind == Metric::Kind::kQuantile && metric.quantile <= 0.5 ? 0.5 : 0.99;
  const std::optional<double> noise = NoiseByIntervals(near, a, b);
  const std::optional<double> value = ValueOf(metric, a);
  if (!noise || !value || *value <= 0) return std::nullopt;
  const double at_near = ValueOf(near, a).value_or(0);
  const double open = std::hypot(LeftOpen(metric, in_a), LeftOpen(metric, in_b));
  return std::max(*noise * std::max(at_near / *value, 1.0), open / *value);
}

// Of what comes seldom, by the numbers alone: three roots of them.
double NoiseOfCounts(const Part& a, const Part& b) {
  const auto variance = [](const Part& part) {
    const auto of = static_cast<double>(part.of);
    return static_cast<double>(part.count) / (of * of);
  };
  return 3 * std::sqrt(variance(a) + variance(b));
}

// The rate above the one that was found at which a search has given up, as a part of it.
double ResolutionOf(const LoadResults& results) {
  double next = 0;
  for (const LoadStep& step : results.steps) {
    if (!step.met && step.rate > *results.rate_found && (next == 0 || step.rate < next)) {
      next = step.rate;
    }
  }
  return next > 0 ? next / *results.rate_found - 1 : 0;
}

}  // namespace

std::optional<double> NoiseOf(const Metric& metric, const LoadResults& a, const LoadResults& b) {
  if (metric.kind == Metric::Kind::kFound) {
    if (!a.rate_found || !b.rate_found) return std::nullopt;
    return ResolutionOf(a) + ResolutionOf(b);
  }
  const bool counts = !metric.IsTime() && !metric.IsRate();
  if (counts && (!metric.operation || metric.kind == Metric::Kind::kWrong)) {
    const Part in_a = PartOf(metric, a), in_b = PartOf(metric, b);
    const bool enough = std::min(a.intervals.size(), b.intervals.size()) >= kLeastIntervals;
    if (!enough || in_a.of == 0 || in_b.of == 0) return std::nullopt;
    return NoiseOfCounts(in_a, in_b);
  }
  if (!metric.operation) return std::nullopt;
  const bool is_quantile = metric.kind == Metric::Kind::kQuantile;
  const bool has_intervals = is_quantile && metric.times == Metric::Times::kResponse &&
                             (metric.quantile == 0.5 || metric.quantile == 0.99);
  if (metric.kind == Metric::Kind::kMean || (is_quantile && !has_intervals)) {
    return NoiseOfTimes(metric, a, b);
  }
  return NoiseByIntervals(metric, a, b);
}

}  // namespace arap::cli
