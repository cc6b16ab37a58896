// arapctl load compare: two runs side by side.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <unistd.h>

#include "client/cli/commands/commands.h"
#include "client/cli/load/compare.h"
#include "client/cli/load/outputs.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "core/base/try.h"
#include "core/files/json_text.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

struct CompareOptions {
  std::string a, b;
  std::vector<Threshold> thresholds;
  bool json = false;
};

Result<LoadResults> ReadResults(const std::string& path) {
  TRY(const std::string text, ReadTextFile(path));
  TRY(const nlohmann::ordered_json json, ParseJson(text, path));
  Result<LoadResults> results = LoadResultsFromJson(json);
  if (results) return results;
  Fault fault = results.error();
  fault.message = path + ": " + fault.message;
  return Fail(std::move(fault));
}

struct Comparison {
  Reply reply;
  bool missed = false;
};

Result<Comparison> CompareFiles(const CompareOptions& options) {
  TRY(const LoadResults first, ReadResults(options.a));
  TRY(const LoadResults second, ReadResults(options.b));
  const NamedResults a{options.a, first}, b{options.b, second};
  const std::vector<Judgement> judgements = JudgeDifference(options.thresholds, first, second);
  const bool missed = std::any_of(judgements.begin(), judgements.end(),
                                  [](const Judgement& one) { return !one.met; });
  return Comparison{{CompareJson(a, b, judgements), CompareText(a, b, judgements, STDOUT_FILENO)},
                    missed};
}

int RunCompare(const CompareOptions& options) {
  const Result<Comparison> compared = CompareFiles(options);
  if (!compared) return Finish(Fail(compared.error()), options.json);
  const int code = Finish(compared->reply, options.json);
  return code == kOk && compared->missed ? static_cast<int>(Exit::kMissed) : code;
}

}  // namespace

void AddLoadCompare(CLI::App& load, Run& run) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* const command =
      load.add_subcommand("compare", "Two results of load --json side by side");
  command->add_option("A", options->a, "the result of one run")
      ->required()
      ->option_text("FILE.json REQUIRED");
  command->add_option("B", options->b, "the result of another, of which is said what has changed")
      ->required()
      ->option_text("FILE.json REQUIRED");
  AddThresholds(
      *command, options->thresholds, &ParseDifferenceThreshold,
      "how much B may differ from A, such as \"p99<5%\", \"rate>-2%\" or, in percentage "
      "points, \"errors<0.1%\"; may be given again. The exit code is 9 when one is missed");
  AddJson(*command, options->json);
  // This one needs no server.
  command->preparse_callback([&load](std::size_t /*words*/) {
    if (CLI::App* const server = load.get_option_group("Server")) server->require_option(0);
  });
  command->callback([options, &run] { run = [options] { return RunCompare(*options); }; });
}

}  // namespace arap::cli
