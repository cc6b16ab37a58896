#include "client/cli/load/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "client/cli/load/noise.h"
#include "client/cli/report.h"
#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

std::optional<double> ChangeOf(const Metric& metric, std::optional<double> a,
                               std::optional<double> b) {
  if (!a || !b) return std::nullopt;
  if (metric.share) return *b - *a;
  if (*a <= 0) return std::nullopt;
  return *b / *a - 1;
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

std::vector<Metric> FiguresNamed(std::initializer_list<const char*> names) {
  std::vector<Metric> metrics;
  for (const char* const name : names) {
    Metric& metric = metrics.emplace_back(*ParseMetric(name));
    metric.share = !metric.IsTime() && !metric.IsRate();
  }
  return metrics;
}

std::vector<Metric> FiguresOfOperations() {
  return FiguresNamed({"rate", "p50", "p90", "p99", "p99.9", "max", "mean", "service.p50",
                       "service.p99", "queue.p99", "solve.p99", "errors", "late", "unsent",
                       "replaced", "wrong"});
}
std::vector<Metric> FiguresOfRuns() { return FiguresNamed({"found", "errors", "lost", "resumed"}); }

}  // namespace

bool LoadDifference::BeyondNoise() const { return change && noise && std::abs(*change) > *noise; }

bool LoadDifference::Worse() const {
  if (!change) return false;
  return metric.IsRate() ? *change < 0 : *change > 0;
}

std::vector<LoadDifference> Compare(const LoadResults& a, const LoadResults& b) {
  std::vector<LoadDifference> differences;
  const auto add = [&](const Metric& metric) {
    LoadDifference one{metric, ValueOf(metric, a), ValueOf(metric, b), {}, {}};
    if (!one.a && !one.b) return;
    one.change = ChangeOf(metric, one.a, one.b);
    one.noise = NoiseOf(metric, a, b);
    differences.push_back(one);
  };
  for (std::size_t k = 0; k < kOperations; ++k) {
    const auto operation = static_cast<Operation>(k);
    if (!a.operations[operation].Any() && !b.operations[operation].Any()) continue;
    for (Metric metric : FiguresOfOperations()) {
      metric.operation = operation;
      add(metric);
    }
  }
  for (const Metric& metric : FiguresOfRuns()) add(metric);
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
  std::string about;
  bool quiet = false;
  for (const LoadDifference& one : Compare(a.results, b.results)) {
    const std::string of(one.metric.operation ? NameOf(*one.metric.operation) : "the run");
    if (about != of) text += Styled(descriptor, Look::kStrong, of) + "\n";
    about = of;
    text += FormatDifference(one, descriptor);
    quiet = quiet || one.noise;
  }
  text += "\n";
  text += Wrapped(
      quiet ? "Worse and better is what is beyond the noise: three standard errors, by how the "
              "intervals differ; of times 1.6 % at least."
            : fmt::format("With fewer than {} whole intervals in a run nothing can be said of the "
                          "noise.",
                          kLeastIntervals),
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
