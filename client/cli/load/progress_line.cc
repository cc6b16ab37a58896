#include "client/cli/load/progress_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "client/cli/load/metric.h"
#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

std::string Span(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  if (whole < 120) return fmt::format("{} s", whole);
  if (whole < 7200) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string ProgressText(const LoadMoment& moment) {
  std::string text =
      moment.of > 0 ? Span(moment.of - moment.seconds) + " left" : Span(std::floor(moment.seconds));
  if (moment.warming_up) text += ", warming up";
  text += "  " + FormatFigure(moment.rate, Unit::kPerSecond);
  if (moment.p99 > 0) {
    text += fmt::format("  p50 {}  p99 {}", FormatMicros(moment.p50), FormatMicros(moment.p99));
  }
  text += fmt::format("  errors {}", moment.errors);
  return text;
}

ProgressLine::ProgressLine(bool silent) : shows_(!silent && IsTerminal(STDERR_FILENO)) {}

ProgressLine::~ProgressLine() {
  if (shown_) fmt::print(stderr, "\r\033[K");
}

void ProgressLine::Show(const LoadMoment& moment) {
  if (!shows_) return;
  const std::string text = ProgressText(moment);
  fmt::print(stderr, "\r{}\033[K",
             moment.errors > 0 ? Styled(STDERR_FILENO, Look::kBad, text) : text);
  std::fflush(stderr);
  shown_ = true;
}

}  // namespace arap::cli
