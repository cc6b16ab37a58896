// A run as text and as CSV.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "client/cli/load/metric.h"
#include "client/cli/load/reports.h"
#include "client/cli/report.h"
#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

constexpr std::size_t kLabel = 13;  // where values begin

std::string TextLine(std::string_view label, std::string_view value) {
  return fmt::format("{:<{}}{}\n", label, kLabel, value);
}

// Right-aligned by characters.
std::string RightAligned(std::string_view text, std::size_t width) {
  const std::size_t length = CharactersIn(text);
  return std::string(length < width ? width - length : 0, ' ').append(text);
}

std::string TimesRow(std::string_view label, const Histogram& times) {
  std::string row = fmt::format("  {:<{}}", label, kLabel - 2);
  for (const double micros : {times.Quantile(0.5), times.Quantile(0.9), times.Quantile(0.99),
                              times.Quantile(0.999), times.Max(), times.Mean()}) {
    row += RightAligned(FormatMicros(micros), 11);
  }
  return row + "\n";
}

std::string TimesTable(const LoadResults& results, int descriptor) {
  std::string header(kLabel, ' ');
  for (const char* const title : {"p50", "p90", "p99", "p99.9", "max", "mean"}) {
    header += RightAligned(title, 11);
  }
  std::string text;
  for (const Operation operation : results.Done()) {
    const OperationResults& done = results.operations[operation];
    if (done.response.Count() == 0) continue;
    std::string rows;
    for (const auto& [label, times] :
         {std::pair("response", &done.response), std::pair("service", &done.service),
          std::pair("queue", &done.queue), std::pair("solve", &done.solve)}) {
      if (times->Count() > 0) rows += TimesRow(label, *times);
    }
    text += Styled(descriptor, Look::kStrong, NameOf(operation)) +
            header.substr(std::min(NameOf(operation).size(), header.size())) + "\n" + rows;
    header.clear();  // the first has it
  }
  return text.empty() ? text : "\n" + text;
}

std::string CountsTable(const LoadResults& results, int descriptor) {
  if (results.Done().empty()) return {};
  constexpr std::array<const char*, 7> kTitles{"a second", "sent",   "answered", "failed",
                                               "late",     "unsent", "replaced"};
  std::string text(kLabel, ' ');
  for (const char* const title : kTitles) text += RightAligned(title, 9);
  text += "\n";
  for (const Operation operation : results.Done()) {
    const OperationResults& done = results.operations[operation];
    const std::string_view name = NameOf(operation);
    text += Styled(descriptor, Look::kStrong, name) + std::string(kLabel - name.size(), ' ') +
            RightAligned(fmt::format("{:.1f}", results.PerSecond(done.answered)), 9);
    for (const std::uint64_t count :
         {done.sent, done.answered, done.failed, done.late, done.unsent, done.replaced}) {
      text += RightAligned(fmt::format("{}", count), 9);
    }
    text += "\n";
  }
  return "\n" + text;
}

std::string StepsTable(const LoadResults& results, int descriptor) {
  if (results.steps.empty()) return {};
  std::string text = "\n" + std::string(kLabel, ' ');
  for (const char* const title : {"offered/s", "answered/s", "p50", "p99"})
    text += RightAligned(title, 12);
  text += "\n";
  for (std::size_t i = 0; i < results.steps.size(); ++i) {
    const LoadStep& step = results.steps[i];
    text += fmt::format("{:<{}}", fmt::format("step {}", i + 1), kLabel) +
            RightAligned(fmt::format("{:.1f}", step.rate), 12) +
            RightAligned(fmt::format("{:.1f}", step.answered), 12) +
            RightAligned(FormatMicros(step.p50), 12) + RightAligned(FormatMicros(step.p99), 12) +
            "  " +
            (step.met ? Styled(descriptor, Look::kGood, "met")
                      : Styled(descriptor, Look::kBad, "missed")) +
            "\n";
  }
  return text;
}

// What went wrong, or that nothing did.
std::string ErrorLines(const LoadResults& results, int descriptor,
                       std::span<const Judgement> judgements) {
  if (results.errors.empty()) return TextLine("errors", "none");
  const Look look = LetPass(judgements, Metric::Kind::kErrors) ? Look::kDoubtful : Look::kBad;
  std::string text;
  for (const LoadError& error : results.errors) {
    std::string value = fmt::format("{} × {}", error.reason, error.count);
    if (!error.code.empty() && error.code != error.reason)
      value += fmt::format(" ({})", error.code);
    text += Styled(descriptor, look, "error") + std::string(kLabel - 5, ' ') + value + "\n";
    if (!error.first.empty()) text += Wrapped(error.first, kLineWidth, kLabel);
  }
  return text;
}

// How the slowest part of each interval went, where there are some.
std::string OverTime(const LoadResults& results) {
  if (results.intervals.size() < 3) return {};
  std::string text;
  for (const Operation operation : results.Done()) {
    std::vector<double> slow;
    for (const Interval& interval : results.intervals) {
      slow.push_back(interval.operations[operation].p99);
    }
    const double highest = *std::max_element(slow.begin(), slow.end());
    if (highest <= 0) continue;
    constexpr std::size_t kColumns = 48;
    text += TextLine(fmt::format("{} p99", NameOf(operation)),
                     fmt::format("{}  up to {}", Sparkline(slow, kColumns), FormatMicros(highest)));
  }
  return text.empty() ? text : "\n" + text;
}

std::string OtherLines(const LoadResults& results, int descriptor,
                       std::span<const Judgement> judgements) {
  std::string text;
  const Look look = LetPass(judgements, Metric::Kind::kWrong) ? Look::kDoubtful : Look::kBad;
  const OperationResults total = results.Total();
  if (total.verified > 0) {
    const std::string different = fmt::format("{} wrong", total.wrong);
    text += TextLine("verified",
                     fmt::format("{} computed here too: {}", Numbered(total.verified, "answer"),
                                 total.wrong == 0 ? std::string("none wrong")
                                                  : Styled(descriptor, look, different)));
  }
  if (results.refused.Count() > 0) {
    text += TextLine("no room", fmt::format("{}, told after p50 {}, max {}",
                                            Numbered(results.refused.Count(), "stream"),
                                            FormatMicros(results.refused.Quantile(0.5)),
                                            FormatMicros(results.refused.Max())));
  }
  if (results.resumptions + results.frames_lost > 0) {
    text +=
        TextLine("resumed", fmt::format("{}, {} lost by it", Numbered(results.resumptions, "time"),
                                        Numbered(results.frames_lost, "update")));
  }
  if (results.echo.Count() > 0) {
    text += TextLine("echo", fmt::format("p50 {}, p99 {}, max {}, without any work",
                                         FormatMicros(results.echo.Quantile(0.5)),
                                         FormatMicros(results.echo.Quantile(0.99)),
                                         FormatMicros(results.echo.Max())));
  }
  if (results.transport && results.transport->round_trip.Count() > 0) {
    const TransportResults& transport = *results.transport;
    const double part = results.PerSecond(total.answered) / transport.PerSecond();
    text += TextLine(
        "transport",
        fmt::format("{:.0f}/s by itself, p50 {}, p99 {}; this is {:.0f} % of it",
                    transport.PerSecond(), FormatMicros(transport.round_trip.Quantile(0.5)),
                    FormatMicros(transport.round_trip.Quantile(0.99)), 100 * part));
  }
  if (results.own_nanos_per_message > 0) {
    text += TextLine("own cost", fmt::format("{} of processor time a message",
                                             FormatMicros(results.own_nanos_per_message / 1000)));
  }
  return text;
}

std::string Span(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  if (whole < 120) return fmt::format("{} s", whole);
  if (whole < 7200) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

std::string LoadText(const LoadResults& results, int descriptor,
                     std::span<const Judgement> judgements) {
  const std::uint64_t updates = results.operations[Operation::kDrag].answered;
  std::string text;
  if (!results.how.empty()) text += Wrapped(results.how, kLineWidth);
  if (results.sessions != results.streams)
    text += TextLine("sessions", fmt::to_string(results.sessions));
  text += TextLine("streams", fmt::to_string(results.streams));
  text += TextLine("connections", fmt::to_string(results.connections));
  text += TextLine("vertices", fmt::to_string(results.vertices));
  text += TextLine("handles", fmt::to_string(results.handles));
  text += TextLine("seconds", fmt::format("{:.2f}", results.seconds) +
                                  (results.warm_up_seconds > 0
                                       ? fmt::format(", after {:.2f} to warm up that count nowhere",
                                                     results.warm_up_seconds)
                                       : ""));
  text += TextLine("updates", fmt::to_string(updates));
  text += TextLine("updates/s", fmt::format("{:.1f}", results.PerSecond(updates)));
  text += TimesTable(results, descriptor);
  text += CountsTable(results, descriptor);
  text += OverTime(results);
  text += StepsTable(results, descriptor);
  text += "\n";
  if (results.rate_found) {
    text += TextLine("rate found", fmt::format("{:.1f} a second", *results.rate_found));
  } else if (!results.steps.empty() &&
             std::none_of(results.steps.begin(), results.steps.end(),
                          [](const LoadStep& step) { return step.met; })) {
    text += TextLine("rate found", "none: not even the lowest was met");
  }
  text += OtherLines(results, descriptor, judgements);
  return text + ErrorLines(results, descriptor, judgements);
}

std::string LoadCsv(const LoadResults& results) {
  std::string text =
      "start,seconds,operation,offered,answered,failed,offered_per_second,answered_per_second,"
      "p50_micros,p99_micros,max_micros\n";
  for (const Interval& interval : results.intervals) {
    const double seconds = interval.seconds > 0 ? interval.seconds : 1;
    for (const Operation operation : results.Done()) {
      const IntervalOperation& done = interval.operations[operation];
      text +=
          fmt::format("{},{},{},{},{},{},{:.3f},{:.3f},{},{},{}\n", interval.start,
                      interval.seconds, NameOf(operation), done.offered, done.answered, done.failed,
                      static_cast<double>(done.offered) / seconds,
                      static_cast<double>(done.answered) / seconds, done.p50, done.p99, done.max);
    }
  }
  return text;
}

std::string Sparkline(const std::vector<double>& values, std::size_t columns) {
  constexpr std::array<const char*, 8> kBlocks{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  std::string text;
  if (values.empty() || columns == 0) return text;
  const std::size_t each = (values.size() + columns - 1) / columns;
  const double highest = *std::max_element(values.begin(), values.end());
  for (std::size_t i = 0; i < values.size(); i += each) {
    const std::size_t end = std::min(i + each, values.size());
    const double value = *std::max_element(values.begin() + static_cast<std::ptrdiff_t>(i),
                                           values.begin() + static_cast<std::ptrdiff_t>(end));
    if (!(value > 0)) {
      text += ' ';
      continue;
    }
    const double part = value / highest * static_cast<double>(kBlocks.size());
    text += kBlocks[std::min(static_cast<std::size_t>(part), kBlocks.size() - 1)];
  }
  return text;
}

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

}  // namespace arap::cli
