// A run as a page.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "client/cli/load/chart.h"
#include "client/cli/load/html_style.h"
#include "client/cli/load/metric.h"
#include "client/cli/load/reports.h"
#include "client/cli/report.h"

namespace arap::cli {
namespace {

constexpr std::array<double, 7> kQuantiles{0.5, 0.75, 0.9, 0.95, 0.99, 0.999, 0.9999};

// A table whose first row has the titles, and the first column what each row is about. Cells are HTML,
// numbers unless `kind` is "words".
std::string HtmlTable(std::string_view caption, const std::vector<std::vector<std::string>>& rows,
                      std::string_view kind = "numbers") {
  std::string html =
      fmt::format("<div class=\"scroll {}\"><table><caption>{}</caption>\n", kind, caption);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    html += i == 0 ? "<thead><tr>" : "<tr>";
    for (std::size_t k = 0; k < rows[i].size(); ++k) {
      const char* const tag = i == 0 ? "th scope=\"col\"" : k == 0 ? "th scope=\"row\"" : "td";
      html += fmt::format("<{}>{}</{}>", tag, rows[i][k], i == 0 || k == 0 ? "th" : "td");
    }
    html += i == 0 ? "</tr></thead><tbody>\n" : "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string FoldedHtml(std::string_view summary, const std::string& html) {
  return fmt::format("<details><summary>{}</summary>{}</details>\n", summary, html);
}

std::string FigureHtml(std::string_view heading, const Chart& chart, const std::string& id) {
  return fmt::format("<section class=\"figure\"><h3>{}</h3>\n{}</section>\n", heading,
                     ChartHtml(chart, id));
}

std::string CardHtml(std::string_view label, std::string_view value, std::string_view note,
                     std::string_view kind = "") {
  return fmt::format("<div class=\"card {}\"><dt>{}</dt><dd>{}<small>{}</small></dd></div>\n", kind,
                     label, value, note);
}

std::string CardsHtml(const LoadResults& results, std::span<const Judgement> judgements) {
  const OperationResults total = results.Total();
  const auto times = [&](double q) {
    return total.response.Count() == 0 ? "–" : FormatMicros(total.response.Quantile(q));
  };
  Metric errors;
  errors.kind = Metric::Kind::kErrors;
  errors.share = true;
  const double failed = ValueOf(errors, results).value_or(results.errors.empty() ? 0 : 1);
  const auto looks = [&](bool none, Metric::Kind kind) {
    return none ? "good" : LetPass(judgements, kind) ? "" : "bad";
  };
  std::string html = "<dl class=\"cards\">\n";
  html += CardHtml("answered", fmt::format("{:.1f}", results.PerSecond(total.answered)),
                   fmt::format("a second; {} in {:.1f} s", total.answered, results.seconds));
  html += CardHtml("median", times(0.5), "response, half of all are faster");
  html += CardHtml("p99", times(0.99), "one of a hundred is slower");
  html += CardHtml("slowest", times(1), "of all responses");
  html += CardHtml("errors", results.errors.empty() ? "none" : FormatFigure(failed, Unit::kShare),
                   fmt::format("{} late, {} never sent", total.late, total.unsent),
                   looks(results.errors.empty(), Metric::Kind::kErrors));
  if (results.rate_found) {
    html += CardHtml("rate found", fmt::format("{:.1f}", *results.rate_found),
                     "a second: the highest that was met");
  }
  if (!judgements.empty()) {
    const auto met = std::count_if(judgements.begin(), judgements.end(),
                                   [](const Judgement& one) { return one.met; });
    const bool all = static_cast<std::size_t>(met) == judgements.size();
    html += CardHtml("thresholds", fmt::format("{} of {}", met, judgements.size()), "were met",
                     all ? "good" : "bad");
  }
  if (total.verified > 0) {
    html += CardHtml("verified", fmt::format("{}", total.verified),
                     total.wrong == 0 ? std::string("computed again here: none wrong")
                                      : fmt::format("computed again here: {} wrong", total.wrong),
                     looks(total.wrong == 0, Metric::Kind::kWrong));
  }
  return html + "</dl>\n";
}

std::string ThresholdsHtml(std::span<const Judgement> judgements) {
  if (judgements.empty()) return {};
  std::vector<std::vector<std::string>> rows{{"threshold", "measured", ""}};
  for (const Judgement& one : judgements) {
    rows.push_back(
        {EscapeHtml(one.threshold.text), EscapeHtml(one.shown),
         one.met ? "<span class=\"good\">met</span>" : "<strong class=\"bad\">missed</strong>"});
  }
  return "<section><h2>Thresholds</h2>\n" + HtmlTable("What was asked of this run", rows, "words") +
         "</section>\n";
}

std::string TimesHtml(const OperationResults& done) {
  std::vector<std::vector<std::string>> rows{{""}};
  for (const double q : kQuantiles) rows[0].push_back(fmt::format("p{:.6g}", 100 * q));
  rows[0].insert(rows[0].end(), {"slowest", "mean"});
  for (const auto& [name, times] :
       {std::pair("response", &done.response), std::pair("service", &done.service),
        std::pair("queue", &done.queue), std::pair("solve", &done.solve)}) {
    if (times->Count() == 0) continue;
    std::vector<std::string>& row = rows.emplace_back();
    row.emplace_back(name);
    for (const double q : kQuantiles) row.push_back(FormatMicros(times->Quantile(q)));
    row.push_back(FormatMicros(times->Max()));
    row.push_back(FormatMicros(times->Mean()));
  }
  return HtmlTable(
      "Times: response from when a message was due, service from when it was sent; queue and solve "
      "as the server says",
      rows);
}

std::string CountsHtml(const LoadResults& results, const OperationResults& done) {
  std::vector<std::vector<std::string>> rows{{"", "number", "a second"}};
  for (const auto& [name, count] :
       {std::pair("sent", done.sent), std::pair("answered", done.answered),
        std::pair("failed", done.failed), std::pair("sent late", done.late),
        std::pair("due and never sent", done.unsent),
        std::pair("replaced by a newer one", done.replaced),
        std::pair("computed here too", done.verified), std::pair("of these wrong", done.wrong)}) {
    rows.push_back({name, fmt::to_string(count), fmt::format("{:.1f}", results.PerSecond(count))});
  }
  return "<section class=\"figure\"><h3>Messages</h3>\n" + HtmlTable("What became of them", rows) +
         "</section>\n";
}

std::string IntervalsHtml(const LoadResults& results, Operation operation) {
  std::vector<std::vector<std::string>> rows{
      {"from", "offered", "answered", "failed", "median", "p99", "slowest"}};
  for (const Interval& interval : results.intervals) {
    const IntervalOperation& done = interval.operations[operation];
    rows.push_back({fmt::format("{:g} s", interval.start), fmt::to_string(done.offered),
                    fmt::to_string(done.answered), fmt::to_string(done.failed),
                    FormatMicros(done.p50), FormatMicros(done.p99), FormatMicros(done.max)});
  }
  return HtmlTable("The run by intervals", rows);
}

std::string OperationSection(const LoadResults& results, Operation operation) {
  const OperationResults& done = results.operations[operation];
  const std::string name(NameOf(operation));
  std::string html = fmt::format("<section><h2>{}</h2>\n<div class=\"figures\">\n", name);
  if (done.response.Count() > 0 && !results.intervals.empty()) {
    html += FigureHtml("Response times over time", TimesChart(results, operation), name + "-times");
  }
  if (done.response.Count() > 0)
    html += FigureHtml("Percentiles", QuantilesChart(results, operation), name + "-parts");
  if (!results.intervals.empty())
    html += FigureHtml("Messages a second", RatesChart(results, operation), name + "-rates");
  html += CountsHtml(results, done) + "</div>\n";
  if (done.response.Count() > 0) html += TimesHtml(done);
  if (!results.intervals.empty()) {
    html += FoldedHtml("Interval by interval", IntervalsHtml(results, operation));
  }
  return html + "</section>\n";
}

std::string StepsHtml(const LoadResults& results) {
  if (results.steps.empty()) return {};
  const std::vector<LoadStep>& steps = results.steps;
  std::vector<std::vector<std::string>> rows{
      {"step", "offered/s", "answered/s", "median", "p99", ""}};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const LoadStep& step = steps[i];
    rows.push_back(
        {fmt::to_string(i + 1), fmt::format("{:.1f}", step.rate),
         fmt::format("{:.1f}", step.answered), FormatMicros(step.p50), FormatMicros(step.p99),
         step.met ? "<span class=\"good\">met</span>" : "<strong class=\"bad\">missed</strong>"});
  }
  return "<section><h2>Rate against latency</h2>\n<div class=\"figures two\">\n" +
         FigureHtml("Response times by rate", StepsChart(results), "steps") +
         "<div class=\"figure\">" +
         HtmlTable("The rates in the order in which they were tried", rows) +
         "</div>\n</div></section>\n";
}

std::string ErrorsHtml(const LoadResults& results) {
  std::string html = "<section><h2>Errors</h2>\n";
  if (results.errors.empty()) return html + "<p class=\"good\">There were none.</p></section>\n";
  std::vector<std::vector<std::string>> rows{{"reason", "count", "the first one"}};
  for (const LoadError& error : results.errors) {
    std::string reason = EscapeHtml(error.reason);
    if (!error.code.empty() && error.code != error.reason) {
      reason += "<br><small>" + EscapeHtml(error.code) + "</small>";
    }
    rows.push_back({std::move(reason), fmt::to_string(error.count), EscapeHtml(error.first)});
  }
  return html + HtmlTable("By reason", rows, "words") + "</section>\n";
}

std::string SetupHtml(const LoadResults& results) {
  std::vector<std::vector<std::string>> rows{{"what", "value"}};
  const auto add = [&](std::string_view name, const std::string& value) {
    rows.push_back({EscapeHtml(name), EscapeHtml(value)});
  };
  add("sessions", fmt::to_string(results.sessions));
  add("streams", fmt::to_string(results.streams));
  add("connections", fmt::to_string(results.connections));
  add("vertices", fmt::to_string(results.vertices));
  add("handles", fmt::to_string(results.handles));
  if (results.warm_up_seconds > 0) {
    add("warm-up, in no figure here", fmt::format("{:.1f} s", results.warm_up_seconds));
  }
  if (results.refused.Count() > 0) {
    add("streams without room",
        fmt::format("{}, told after {} in the median", results.refused.Count(),
                    FormatMicros(results.refused.Quantile(0.5))));
  }
  if (results.resumptions + results.frames_lost > 0) {
    add("resumptions", fmt::format("{}, {} lost by them", results.resumptions,
                                   Numbered(results.frames_lost, "update")));
  }
  if (results.echo.Count() > 0) {
    add("echo, a message without work",
        fmt::format("median {}, p99 {}", FormatMicros(results.echo.Quantile(0.5)),
                    FormatMicros(results.echo.Quantile(0.99))));
  }
  if (results.transport && results.transport->round_trip.Count() > 0) {
    const TransportResults& transport = *results.transport;
    add("transport by itself, with the same sizes",
        fmt::format("median {}, p99 {}, {}", FormatMicros(transport.round_trip.Quantile(0.5)),
                    FormatMicros(transport.round_trip.Quantile(0.99)),
                    FormatFigure(transport.PerSecond(), Unit::kPerSecond)));
  }
  if (results.own_nanos_per_message > 0) {
    add("own cost of a message", FormatMicros(results.own_nanos_per_message / 1000));
  }
  for (const auto& [flag, value] : results.settings.items()) {
    add(flag, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return "<section><h2>Set-up</h2>\n" + HtmlTable("What was run", rows, "words") + "</section>\n";
}

}  // namespace

std::string LoadHtml(const LoadResults& results, std::span<const Judgement> judgements) {
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<title>arapctl load</title>\n<style>\n{}</style></head>\n<body><main>\n"
      "<header><h1>arapctl load</h1><p>{}</p></header>\n",
      kReportStyle, EscapeHtml(results.how));
  html += CardsHtml(results, judgements);
  html += ThresholdsHtml(judgements);
  html += StepsHtml(results);
  for (const Operation operation : results.Done()) html += OperationSection(results, operation);
  html += ErrorsHtml(results);
  html += SetupHtml(results);
  return html + "</main></body></html>\n";
}

}  // namespace arap::cli
