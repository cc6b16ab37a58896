#include "client/cli/load/threshold.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "client/cli/terminal.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

using Relation = Threshold::Relation;

tl::unexpected<Fault> BadThreshold(const std::string& text, std::string_view why) {
  return Fail(FaultKind::kInvalidOption, fmt::format("'{}' is no threshold: {}", text, why));
}

struct Bound {
  double number = 0;
  std::string_view unit;
};

Result<Bound> ParseBound(const std::string& text, std::string_view bound) {
  const char* const end = bound.data() + bound.size();
  if (bound.starts_with('+')) bound.remove_prefix(1);
  Bound parsed;
  const auto [stop, error] = std::from_chars(bound.data(), end, parsed.number);
  if (error != std::errc() || !std::isfinite(parsed.number)) {
    return BadThreshold(text, fmt::format("'{}' does not begin with a number", bound));
  }
  parsed.unit = {stop, static_cast<std::size_t>(end - stop)};
  return parsed;
}

// Everything before the bound, and the text of that.
Result<std::pair<Threshold, std::string>> ParseFront(std::string_view said) {
  Threshold threshold;
  for (const char c : said) {
    if (c != ' ') threshold.text += c;
  }
  const std::string& text = threshold.text;
  const std::size_t at = text.find_first_of("<>");
  if (at == std::string::npos) {
    return BadThreshold(text, "it has none of < <= > >=, as in p99<20ms");
  }
  const bool equal = text.substr(at + 1, 1) == "=";
  const bool above = text[at] == '>';
  threshold.relation = above ? (equal ? Relation::kAtLeast : Relation::kAbove)
                             : (equal ? Relation::kAtMost : Relation::kBelow);
  TRY(threshold.metric, ParseMetric(text.substr(0, at)));
  std::string bound = text.substr(at + (equal ? 2 : 1));
  return std::pair(std::move(threshold), std::move(bound));
}

}  // namespace

bool Threshold::MetBy(double value) const {
  switch (relation) {
    case Relation::kBelow:
      return value < bound;
    case Relation::kAtMost:
      return value <= bound;
    case Relation::kAbove:
      return value > bound;
    case Relation::kAtLeast:
      return value >= bound;
  }
  return false;
}

Result<Threshold> ParseThreshold(std::string_view text) {
  TRY(auto front, ParseFront(text));
  Threshold& threshold = front.first;
  TRY(const Bound bound, ParseBound(threshold.text, front.second));
  if (bound.number < 0) return BadThreshold(threshold.text, "its bound is below 0");
  threshold.bound = bound.number;
  if (threshold.metric.IsTime()) {
    constexpr std::array<std::pair<std::string_view, double>, 4> kUnits{
        {{"us", 1}, {"µs", 1}, {"ms", 1e3}, {"s", 1e6}}};
    const auto unit = std::find_if(kUnits.begin(), kUnits.end(),
                                   [&](const auto& one) { return one.first == bound.unit; });
    if (unit == kUnits.end()) {
      return BadThreshold(threshold.text, "a time has the unit us, ms or s");
    }
    threshold.bound *= unit->second;
  } else if (threshold.metric.IsRate()) {
    if (!bound.unit.empty() && bound.unit != "/s") {
      return BadThreshold(threshold.text, "a rate is a number a second, without a unit or with /s");
    }
  } else if (bound.unit == "%") {
    if (bound.number > 100) return BadThreshold(threshold.text, "its bound is above 100 %");
    threshold.metric.share = true;
    threshold.bound /= 100;
  } else if (!bound.unit.empty()) {
    return BadThreshold(threshold.text, "a count has no unit, or % for a part of all");
  }
  return std::move(threshold);
}

Result<Threshold> ParseDifferenceThreshold(std::string_view text) {
  TRY(auto front, ParseFront(text));
  Threshold& threshold = front.first;
  TRY(const Bound bound, ParseBound(threshold.text, front.second));
  if (bound.unit != "%") {
    return BadThreshold(threshold.text, "a difference is in percent, as in p99<5%");
  }
  threshold.metric.share = !threshold.metric.IsTime() && !threshold.metric.IsRate();
  threshold.bound = bound.number / 100;
  return std::move(threshold);
}

std::vector<Judgement> Judge(std::span<const Threshold> thresholds, const LoadResults& results) {
  std::vector<Judgement> judgements;
  for (const Threshold& threshold : thresholds) {
    const std::optional<double> value = ValueOf(threshold.metric, results);
    judgements.push_back(
        {threshold, value, value && threshold.MetBy(*value),
         value ? FormatFigure(*value, threshold.metric.unit()) : "nothing to measure"});
  }
  return judgements;
}

bool LetPass(std::span<const Judgement> judgements, Metric::Kind kind) {
  const auto of_it = [kind](const Judgement& one) { return one.threshold.metric.kind == kind; };
  return std::any_of(judgements.begin(), judgements.end(), of_it) &&
         std::all_of(judgements.begin(), judgements.end(),
                     [&](const Judgement& one) { return one.met || !of_it(one); });
}

std::string FormatJudgements(std::span<const Judgement> judgements, int descriptor) {
  std::size_t width = 0;
  for (const Judgement& one : judgements) {
    width = std::max(width, CharactersIn(one.threshold.text));
  }
  std::string text;
  for (const Judgement& one : judgements) {
    const std::string& said = one.threshold.text;
    text += fmt::format("threshold    {}{}  {}  {}\n", said,
                        std::string(width - CharactersIn(said), ' '),
                        one.met ? Styled(descriptor, Look::kGood, "met   ")
                                : Styled(descriptor, Look::kBad, "missed"),
                        one.shown);
  }
  return text;
}

nlohmann::ordered_json ToJson(std::span<const Judgement> judgements) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Judgement& one : judgements) {
    list.push_back({{"threshold", one.threshold.text},
                    {"value", one.value ? nlohmann::ordered_json(*one.value) : nullptr},
                    {"met", one.met}});
  }
  return list;
}

}  // namespace arap::cli
