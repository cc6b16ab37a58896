#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/load/chart.h"
#include "client/cli/load/metric.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

// Of a logarithmic axis: 0 is no time, and breaks the line.
double OrNaN(double value) { return value > 0 ? value : std::numeric_limits<double>::quiet_NaN(); }

ChartSeries QuantilesOf(std::string name, int style, const Histogram& times) {
  ChartSeries series{std::move(name), style, {}, false};
  const double count = static_cast<double>(times.Count());
  double below = 0;
  series.points.emplace_back(1, times.Min());
  for (const Histogram::Bucket& bucket : times.Buckets()) {
    below += static_cast<double>(bucket.count);
    const double slower = std::max(count - below, 1.0);  // the slowest ends the line
    series.points.emplace_back(
        count / slower, std::clamp((bucket.low + bucket.high) / 2, times.Min(), times.Max()));
  }
  return series;
}

// So few that each is worth a circle.
bool HasFew(const LoadResults& results) { return results.intervals.size() <= 20; }

}  // namespace

Chart TimesChart(const LoadResults& results, Operation operation) {
  Chart chart;
  chart.title = fmt::format("{}: response times over time", NameOf(operation));
  const bool few = HasFew(results);
  chart.series = {{"median", 1, {}, few}, {"p99", 2, {}, few}, {"slowest", 3, {}, few}};
  double lowest = 0, highest = 0;
  for (const Interval& interval : results.intervals) {
    const IntervalOperation& done = interval.operations[operation];
    const double middle = interval.start + interval.seconds / 2;
    for (const auto& [i, micros] :
         {std::pair(0, done.p50), std::pair(1, done.p99), std::pair(2, done.max)}) {
      chart.series[static_cast<std::size_t>(i)].points.emplace_back(middle, OrNaN(micros));
    }
    if (done.answered > 0) {
      lowest = lowest > 0 ? std::min(lowest, done.p50) : done.p50;
      highest = std::max(highest, done.max);
    }
    chart.bands.push_back(
        {interval.start, interval.start + interval.seconds,
         fmt::format("{:g} s: median {}, p99 {}, slowest {}", interval.start,
                     FormatMicros(done.p50), FormatMicros(done.p99), FormatMicros(done.max))});
  }
  const Histogram& all = results.operations[operation].response;
  chart.description = fmt::format("Over the whole run median {}, p99 {}, slowest {}.",
                                  FormatMicros(all.Quantile(0.5)), FormatMicros(all.Quantile(0.99)),
                                  FormatMicros(all.Max()));
  const Interval& last = results.intervals.back();
  chart.x = SecondsAxis(last.start + last.seconds);
  chart.y = MicrosAxis("", lowest, highest);
  return chart;
}

Chart RatesChart(const LoadResults& results, Operation operation) {
  Chart chart;
  chart.title = fmt::format("{}: rates over time", NameOf(operation));
  const bool few = HasFew(results);
  chart.series = {{"answered", 1, {}, few}, {"offered", 4, {}, few}};
  const bool any_failed = results.operations[operation].failed > 0;
  if (any_failed) chart.series.push_back({"failed", 3, {}, few});
  double highest = 0;
  for (const Interval& interval : results.intervals) {
    const IntervalOperation& done = interval.operations[operation];
    const double seconds = interval.seconds > 0 ? interval.seconds : 1;
    const double middle = interval.start + interval.seconds / 2;
    const double offered = static_cast<double>(done.offered) / seconds;
    const double answered = static_cast<double>(done.answered) / seconds;
    const double failed = static_cast<double>(done.failed) / seconds;
    chart.series[0].points.emplace_back(middle, answered);
    chart.series[1].points.emplace_back(middle, offered);
    if (any_failed) chart.series[2].points.emplace_back(middle, failed);
    highest = std::max({highest, offered, answered, failed});
    chart.bands.push_back({interval.start, interval.start + interval.seconds,
                           fmt::format("{:g} s: offered {:.1f}/s, answered {:.1f}/s, failed {}",
                                       interval.start, offered, answered, done.failed)});
  }
  const OperationResults& all = results.operations[operation];
  chart.description = fmt::format("{} sent, {} answered, {} failed, {} late, {} never sent.",
                                  all.sent, all.answered, all.failed, all.late, all.unsent);
  const Interval& last = results.intervals.back();
  chart.x = SecondsAxis(last.start + last.seconds);
  chart.y = CountAxis("", highest);
  return chart;
}

Chart QuantilesChart(const LoadResults& results, Operation operation) {
  const OperationResults& done = results.operations[operation];
  Chart chart;
  chart.title = fmt::format("{}: percentiles", NameOf(operation));
  chart.series.push_back(QuantilesOf("response", 1, done.response));
  double lowest = done.response.Min();
  if (done.service.Count() > 0) {
    chart.series.push_back(QuantilesOf("service", 2, done.service));
    lowest = std::min(lowest, done.service.Min());
  }
  if (done.solve.Count() > 0) {
    chart.series.push_back(QuantilesOf("solve", 4, done.solve));
    lowest = std::min(lowest, done.solve.Min());
  }
  chart.description =
      fmt::format("Response: {} percent within {}, {} percent within {}, all within {}.", 50,
                  FormatMicros(done.response.Quantile(0.5)), 99,
                  FormatMicros(done.response.Quantile(0.99)), FormatMicros(done.response.Max()));
  chart.x = QuantileAxis(static_cast<double>(done.response.Count()));
  chart.y =
      MicrosAxis("", std::max(lowest, 1.0 / 16), std::max(done.response.Max(), done.service.Max()));
  return chart;
}

Chart StepsChart(const LoadResults& results) {
  std::vector<LoadStep> steps = results.steps;
  std::stable_sort(steps.begin(), steps.end(),
                   [](const LoadStep& a, const LoadStep& b) { return a.rate < b.rate; });
  Chart chart;
  chart.title = "Response times against the offered rate";
  chart.series = {{"median", 1, {}, true}, {"p99", 2, {}, true}};
  double lowest = 0, highest = 0;
  for (const LoadStep& step : steps) {
    chart.series[0].points.emplace_back(step.rate, OrNaN(step.p50));
    chart.series[1].points.emplace_back(step.rate, OrNaN(step.p99));
    if (step.p50 > 0) lowest = lowest > 0 ? std::min(lowest, step.p50) : step.p50;
    highest = std::max(highest, step.p99);
  }
  if (results.rate_found) {
    chart.at_x.emplace_back(*results.rate_found,
                            fmt::format("{:.1f}/s found", *results.rate_found));
  }
  chart.description =
      results.rate_found
          ? fmt::format("The highest rate that was met is {:.1f} a second.", *results.rate_found)
          : Numbered(steps.size(), "rate") + " tried.";
  chart.x = CountAxis("offered messages a second", steps.back().rate);
  chart.y = MicrosAxis("", lowest, highest);
  return chart;
}

}  // namespace arap::cli
