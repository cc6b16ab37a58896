#include "client/cli/load/outputs.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "client/cli/commands/commands.h"
#include "client/cli/load/reports.h"
#include "client/cli/report.h"
#include "client/cli/terminal.h"
#include "core/base/try.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

bool SpeaksOf(std::span<const Judgement> judgements, Metric::Kind kind) {
  return std::any_of(judgements.begin(), judgements.end(),
                     [kind](const Judgement& one) { return one.threshold.metric.kind == kind; });
}

Status WriteReports(const LoadResults& results, const LoadOutputs& outputs,
                    std::span<const Judgement> judgements) {
  if (!outputs.json.empty()) {
    nlohmann::ordered_json json = ToJson(results);
    if (!judgements.empty()) json["thresholds"] = ToJson(judgements);
    CHECK_OK(WriteTextFile(outputs.json, JsonText(json)));
  }
  if (!outputs.csv.empty()) CHECK_OK(WriteTextFile(outputs.csv, LoadCsv(results)));
  if (!outputs.html.empty()) CHECK_OK(WriteTextFile(outputs.html, LoadHtml(results, judgements)));
  return {};
}

}  // namespace

bool LoadOutputs::TakeStandardOutput() const {
  return json == kStandardStream || csv == kStandardStream || html == kStandardStream;
}

void AddThresholds(CLI::App& command, std::vector<Threshold>& thresholds,
                   Result<Threshold> (*parse)(std::string_view), const std::string& help) {
  command
      .add_option_function<std::vector<std::string>>(
          "--threshold",
          [&thresholds, parse](const std::vector<std::string>& texts) {
            thresholds.clear();
            for (const std::string& text : texts) thresholds.push_back(*parse(text));
          },
          help)
      ->check(CLI::Validator(
          [parse](std::string& text) {
            const Result<Threshold> threshold = parse(text);
            return threshold ? std::string() : threshold.error().message;
          },
          ""))
      ->allow_extra_args(false)
      ->option_text("RULE");
}

void AddLoadOutputs(CLI::App& command, LoadOutputs& outputs) {
  AddOutput(command, "--json", outputs.json, "write the result with its histograms", "FILE.json");
  AddOutput(command, "--csv", outputs.csv, "write a line for each interval and operation",
            "FILE.csv");
  AddOutput(command, "--html", outputs.html, "write a report with pictures, one file for a browser",
            "FILE.html");
  AddThresholds(command, outputs.thresholds, &ParseThreshold,
                "what is asked of the run, such as \"p99<20ms\", \"errors<0.1%\", \"rate>1000\" or "
                "\"drag.p99.9<50ms\"; may be given again. The exit code is 9 when one is missed");
}

Exit VerdictOf(const LoadResults& results, std::span<const Judgement> judgements) {
  const OperationResults total = results.Total();
  if (total.answered == 0) return Exit::kFailed;
  if (total.wrong > 0 && !SpeaksOf(judgements, Metric::Kind::kWrong)) return Exit::kFailed;
  if (std::any_of(judgements.begin(), judgements.end(),
                  [](const Judgement& one) { return !one.met; })) {
    return Exit::kMissed;
  }
  const bool errors = !results.errors.empty() || total.failed > 0;
  return errors && !SpeaksOf(judgements, Metric::Kind::kErrors) ? Exit::kFailed : Exit::kOk;
}

int TellLoad(const LoadResults& results, const LoadOutputs& outputs) {
  const std::vector<Judgement> judgements = Judge(outputs.thresholds, results);
  const int descriptor = outputs.TakeStandardOutput() ? STDERR_FILENO : STDOUT_FILENO;
  Say(LoadText(results, descriptor, judgements) + FormatJudgements(judgements, descriptor));
  if (const Status written = WriteReports(results, outputs, judgements); !written) {
    return Complain(written.error());
  }
  const Exit verdict = VerdictOf(results, judgements);
  const std::string name = Styled(STDERR_FILENO, Look::kBad, "arapctl:");
  if (verdict == Exit::kMissed) {
    const auto missed = std::count_if(judgements.begin(), judgements.end(),
                                      [](const Judgement& one) { return !one.met; });
    fmt::print(stderr, "{} {} of {} thresholds missed\n", name, missed, judgements.size());
  } else if (verdict != Exit::kOk && !results.errors.empty()) {
    const LoadError& first = results.errors.front();
    fmt::print(stderr, "{} first error: {}: {}\n", name, first.reason, first.first);
  } else if (verdict != Exit::kOk) {
    const std::uint64_t wrong = results.Total().wrong;
    fmt::print(stderr, "{} {}\n", name,
               wrong > 0 ? fmt::format("{} not what was computed here", Numbered(wrong, "answer"))
                         : std::string("no update was answered in time"));
  }
  return static_cast<int>(verdict);
}

}  // namespace arap::cli
