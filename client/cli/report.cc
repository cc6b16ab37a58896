#include "client/cli/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "client/cli/terminal.h"
#include "core/base/code_point.h"

namespace arap::cli {

std::string Printable(std::string_view text) {
  constexpr std::size_t kMost = 2000;
  std::string out;
  while (!text.empty() && out.size() < kMost) {
    const CodePoint point(text);
    if (point.IsHarmless()) {
      out += text.substr(0, point.length);
    } else {
      out += point.value < 0x100 ? fmt::format("\\x{:02x}", point.value)
                                 : fmt::format("\\u{:04x}", point.value);
    }
    text.remove_prefix(point.length);
  }
  return text.empty() ? out : out + "…";
}

std::string JsonText(const nlohmann::ordered_json& json) {
  using Json = nlohmann::ordered_json;
  return json.dump(2, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace) + "\n";
}

std::string Numbered(std::uint64_t count, std::string_view one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

std::string ReasonOf(const Fault& fault) { return std::string(InfoOf(fault.kind).reason); }

std::string Describe(const Fault& fault) {
  std::string text = ReasonOf(fault) + ": " + fault.message;
  std::vector<std::string> extra;
  if (!fault.elements.empty()) {
    extra.push_back(fmt::format("elements {}", fmt::join(fault.elements, " ")));
  }
  if (!fault.field.empty()) extra.push_back("field " + fault.field);
  for (const auto& [name, value] : fault.details) {
    extra.push_back(fmt::format("{} = {}", name, value));
  }
  if (!extra.empty()) text += fmt::format(" ({})", fmt::join(extra, "; "));
  return Printable(text);
}

int Complain(const Fault& fault) {
  fmt::print(stderr, "{} {}\n", Styled(STDERR_FILENO, Look::kBad, "arapctl:"), Describe(fault));
  if (fault.kind == FaultKind::kUnauthenticated) {
    fmt::print(
        stderr,
        "arapctl: the server asks who you are: give --token-file FILE, set ARAPCTL_TOKEN, or "
        "give --tls-cert and --tls-key; `arapctl token add` makes tokens\n");
  }
  return static_cast<int>(ExitOf(fault.kind));
}

int ExitCode(const Status& done) { return done ? kOk : Complain(done.error()); }

namespace {

// What the program has said, once for all of it.
struct Said {
  std::vector<Warning> warnings;
  std::string output_taken_by;
};
Said& TheSaid() {
  static Said& said = *new Said;  // never destroyed: threads may speak until the end
  return said;
}

}  // namespace

const std::vector<Warning>& PrintedWarnings() { return TheSaid().warnings; }

bool TakeStandardOutput(const std::string& flag) {
  std::string& taken_by = TheSaid().output_taken_by;
  if (taken_by.empty()) taken_by = flag;
  return taken_by == flag;
}

void Say(std::string_view text) {
  fmt::print(TheSaid().output_taken_by.empty() ? stdout : stderr, "{}", text);
}

void PrintWarnings(const std::vector<Warning>& warnings) {
  std::vector<Warning>& printed = TheSaid().warnings;
  printed.insert(printed.end(), warnings.begin(), warnings.end());
  constexpr std::size_t kMost = 20;
  for (std::size_t i = 0; i < std::min(warnings.size(), kMost); ++i) {
    fmt::print(stderr, "{} {}: {}\n", Styled(STDERR_FILENO, Look::kDoubtful, "arapctl: warning:"),
               Printable(warnings[i].kind), Printable(warnings[i].message));
  }
  if (warnings.size() > kMost) {
    fmt::print(stderr, "arapctl: {} more warnings\n", warnings.size() - kMost);
  }
}

Percentiles PercentilesOf(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const auto at = [&](double percent) {
    const double rank = std::ceil(percent / 100 * static_cast<double>(samples.size()));
    return samples[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  };
  return {at(50), at(90), at(99), samples.back()};
}

nlohmann::ordered_json ToJson(const Percentiles& times) {
  return {{"p50", times.p50}, {"p90", times.p90}, {"p99", times.p99}, {"max", times.max}};
}

}  // namespace arap::cli
