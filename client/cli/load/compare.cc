#include "client/cli/load/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "client/cli/report.h"
#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

constexpr double kResolved = 0.016;  // of a time, by two histograms

std::optional<double> ChangeOf(const Metric& metric, std::optional<double> a,
                               std::optional<double> b) {
  if (!a || !b) return std::nullopt;
  if (metric.share) return *b - *a;
  if (*a <= 0) return std::nullopt;
  return *b / *a - 1;
}

// The figure in each whole interval where there is one. Nothing for figures that intervals do not have.
std::vector<double> ByInterval(const Metric& metric, const LoadResults& results) {
  std::vector<double> values;
  if (!metric.operation || results.intervals.empty()) return values;
  const bool response =
      metric.kind == Metric::Kind::kQuantile && metric.times == Metric::Times::kResponse;
  const double length = results.intervals.front().seconds;
  for (const Interval& interval : results.intervals) {
    const IntervalOperation& done = interval.operations[*metric.operation];
    const auto answered = static_cast<double>(done.answered);
    const auto failed = static_cast<double>(done.failed);
    if (interval.seconds < length) continue;
    if (metric.kind == Metric::Kind::kRate) {
      values.push_back(answered / interval.seconds);
    } else if (metric.kind == Metric::Kind::kErrors && answered + failed > 0) {
      values.push_back(failed / (answered + failed));
    } else if (response && answered > 0 && metric.quantile == 0.5) {
      values.push_back(done.p50);
    } else if (response && answered > 0 && metric.quantile == 0.99) {
      values.push_back(done.p99);
    }
  }
  return values;
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

std::optional<double> NoiseOf(const Metric& metric, const LoadResults& a, const LoadResults& b) {
  const std::vector<double> in_a = ByInterval(metric, a), in_b = ByInterval(metric, b);
  if (std::min(in_a.size(), in_b.size()) < LoadDifference::kLeastIntervals) return std::nullopt;
  const bool median = metric.kind == Metric::Kind::kQuantile && metric.quantile == 0.5;
  const Spread of_a = median ? SpreadOfMedian(in_a) : SpreadOfMean(in_a);
  const Spread of_b = median ? SpreadOfMedian(in_b) : SpreadOfMean(in_b);
  const double noise = 3 * std::sqrt(of_a.variance + of_b.variance);
  if (metric.share) return noise;
  if (of_a.center <= 0) return std::nullopt;
  return std::max(noise / of_a.center, metric.IsTime() ? kResolved : 0);
}

// Percent of the first, or percentage points.
std::string FormatChange(const Metric& metric, double change) {
  return metric.share ? fmt::format("{:+.2f} pp", 100 * change)
                      : fmt::format("{:+.1f} %", 100 * change);
}

std::string ShownFigure(const Metric& metric, std::optional<double> value) {
  return value ? FormatFigure(*value, metric.unit()) : "-";
}

std::string Column(std::string_view text, std::size_t width) {
  const std::size_t length = CharactersIn(text);
  return std::string(length < width ? width - length : 0, ' ').append(text);
}

std::string FormatDifference(const LoadDifference& one, int descriptor) {
  Metric plain = one.metric;
  plain.operation.reset();
  std::string line = fmt::format("  {:<12}", NameOf(plain));
  line += Column(ShownFigure(one.metric, one.a), 14) + Column(ShownFigure(one.metric, one.b), 14);
  line += Column(one.change ? FormatChange(one.metric, *one.change) : "-", 12);
  line += Column(one.noise ? FormatChange(one.metric, *one.noise).substr(1) : "-", 11);
  if (one.BeyondNoise()) {
    line += one.Worse() ? "  " + Styled(descriptor, Look::kBad, "worse")
                        : "  " + Styled(descriptor, Look::kGood, "better");
  }
  return line + "\n";
}

nlohmann::ordered_json OrNull(std::optional<double> value) {
  return value ? nlohmann::ordered_json(*value) : nullptr;
}

std::string SettingOf(const LoadResults& results, const std::string& name) {
  const auto found = results.settings.find(name);
  if (found == results.settings.end()) return "-";
  return Printable(found->is_string() ? found->get<std::string>() : found->dump());
}

// Where the results went, which says nothing of the run.
constexpr std::array<std::string_view, 4> kOutputSettings{"--json", "--csv", "--html",
                                                          "--threshold"};

// The names of the settings that are not the same in both.
std::vector<std::string> DifferentSettings(const LoadResults& a, const LoadResults& b) {
  std::vector<std::string> names;
  for (const LoadResults* const results : {&a, &b}) {
    for (const auto& [name, value] : results->settings.items()) {
      const bool known =
          std::find(names.begin(), names.end(), name) != names.end() ||
          std::find(kOutputSettings.begin(), kOutputSettings.end(), name) != kOutputSettings.end();
      if (!known && SettingOf(a, name) != SettingOf(b, name)) names.push_back(name);
    }
  }
  return names;
}

}  // namespace

bool LoadDifference::BeyondNoise() const { return change && noise && std::abs(*change) > *noise; }

bool LoadDifference::Worse() const {
  if (!change) return false;
  return metric.kind == Metric::Kind::kRate ? *change < 0 : *change > 0;
}

std::vector<LoadDifference> Compare(const LoadResults& a, const LoadResults& b) {
  using Kind = Metric::Kind;
  using Times = Metric::Times;
  const std::array<Metric, 11> figures{{{{}, Times::kResponse, Kind::kRate, 0, false},
                                        {{}, Times::kResponse, Kind::kQuantile, 0.5, false},
                                        {{}, Times::kResponse, Kind::kQuantile, 0.9, false},
                                        {{}, Times::kResponse, Kind::kQuantile, 0.99, false},
                                        {{}, Times::kResponse, Kind::kQuantile, 0.999, false},
                                        {{}, Times::kResponse, Kind::kMax, 0, false},
                                        {{}, Times::kResponse, Kind::kMean, 0, false},
                                        {{}, Times::kQueue, Kind::kQuantile, 0.99, false},
                                        {{}, Times::kSolve, Kind::kQuantile, 0.99, false},
                                        {{}, Times::kResponse, Kind::kErrors, 0, true},
                                        {{}, Times::kResponse, Kind::kLate, 0, true}}};
  std::vector<LoadDifference> differences;
  for (std::size_t k = 0; k < kOperations; ++k) {
    const auto operation = static_cast<Operation>(k);
    if (!a.operations[operation].Any() && !b.operations[operation].Any()) continue;
    for (Metric metric : figures) {
      metric.operation = operation;
      LoadDifference one{metric, ValueOf(metric, a), ValueOf(metric, b), {}, {}};
      if (!one.a && !one.b) continue;
      one.change = ChangeOf(metric, one.a, one.b);
      one.noise = NoiseOf(metric, a, b);
      differences.push_back(one);
    }
  }
  return differences;
}

std::vector<Judgement> JudgeDifference(std::span<const Threshold> thresholds, const LoadResults& a,
                                       const LoadResults& b) {
  std::vector<Judgement> judgements;
  for (const Threshold& threshold : thresholds) {
    const Metric& metric = threshold.metric;
    const std::optional<double> change = ChangeOf(metric, ValueOf(metric, a), ValueOf(metric, b));
    judgements.push_back({threshold, change, change && threshold.MetBy(*change),
                          change ? FormatChange(metric, *change) : "nothing to compare"});
  }
  return judgements;
}

std::string CompareText(const NamedResults& a, const NamedResults& b,
                        std::span<const Judgement> judgements, int descriptor) {
  std::string text;
  for (const auto& [letter, run] : {std::pair("A", &a), std::pair("B", &b)}) {
    text += fmt::format("{}  {}\n", letter, run->name);
    if (!run->results.how.empty()) text += Wrapped(run->results.how, kLineWidth, 3);
  }
  for (const std::string& name : DifferentSettings(a.results, b.results)) {
    text += fmt::format("{:<14}{:>14}{:>14}\n", name, SettingOf(a.results, name),
                        SettingOf(b.results, name));
  }
  text += "\n" + std::string(14, ' ');
  for (const auto& [title, width] :
       {std::pair("A", 14), std::pair("B", 14), std::pair("change", 12), std::pair("noise", 11)}) {
    text += Column(title, static_cast<std::size_t>(width));
  }
  text += "\n";
  std::optional<Operation> operation;
  bool quiet = false;
  for (const LoadDifference& one : Compare(a.results, b.results)) {
    if (operation != one.metric.operation) {
      operation = one.metric.operation;
      text += Styled(descriptor, Look::kStrong, NameOf(*operation)) + "\n";
    }
    text += FormatDifference(one, descriptor);
    quiet = quiet || one.noise;
  }
  text += "\n";
  text += Wrapped(
      quiet ? "Worse and better is what is beyond the noise: three standard errors, by how the "
              "intervals differ; of times 1.6 % at least."
            : fmt::format("With fewer than {} whole intervals in a run nothing can be said of the "
                          "noise.",
                          LoadDifference::kLeastIntervals),
      kLineWidth);
  return text + FormatJudgements(judgements, descriptor);
}

nlohmann::ordered_json CompareJson(const NamedResults& a, const NamedResults& b,
                                   std::span<const Judgement> judgements) {
  nlohmann::ordered_json figures = nlohmann::ordered_json::array();
  for (const LoadDifference& one : Compare(a.results, b.results)) {
    figures.push_back(
        {{"figure", NameOf(one.metric)},
         {"a", OrNull(one.a)},
         {"b", OrNull(one.b)},
         {"change", OrNull(one.change)},
         {"noise", OrNull(one.noise)},
         {"beyond_noise", one.noise ? nlohmann::ordered_json(one.BeyondNoise()) : nullptr}});
  }
  nlohmann::ordered_json settings = nlohmann::ordered_json::object();
  for (const std::string& name : DifferentSettings(a.results, b.results)) {
    settings[name] = {SettingOf(a.results, name), SettingOf(b.results, name)};
  }
  return {{"a", a.name},
          {"b", b.name},
          {"different_settings", std::move(settings)},
          {"figures", std::move(figures)},
          {"thresholds", ToJson(judgements)}};
}

}  // namespace arap::cli
