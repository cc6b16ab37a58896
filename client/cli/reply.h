// Answers for people and for programs: the same command prints lines, or with --json one JSON document
// on standard output, errors included (docs/arapctl.md).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "arap/base/result.h"
#include "client/cli/commands/commands.h"

namespace arap::cli {

using OrderedJson = nlohmann::ordered_json;

struct Reply {
  OrderedJson json;
  std::string text;  // whole lines, printable
};

// {"error": {"exit_code": 3, "class": "refused", "reason": …, "message": …, "elements": […], "field": …,
// "details": {…}}}; what is empty is left out.
OrderedJson ErrorJson(const Fault& fault);
// The same for a wrong command line, which has no reason.
OrderedJson UsageErrorJson(const std::string& message);

// [{"kind": …, "count": …, "elements": […], "message": …}].
OrderedJson WarningsJson(const std::vector<Warning>& warnings);

// --json.
void AddJson(CLI::App& command, bool& json);

// Prints the answer, or complains; of JSON it is the document, with the warnings that were printed since
// the command began as "warnings" unless it has some. Answers the exit code.
int Finish(const Result<Reply>& reply, bool json);

// When `command` is chosen, `run` does `action` with the options as they were parsed, and prints what it
// answers. `Options` has a member `json`, which is set by --json.
template <class Options>
void SetReply(CLI::App& command, Run& run, std::shared_ptr<Options> options,
              Result<Reply> (*action)(const Options&)) {
  AddJson(command, options->json);
  command.callback([&run, options, action] {
    run = [options, action] { return Finish(action(*options), options->json); };
  });
}

// "2026-11-30T10:15:00Z".
std::string FormatTime(std::chrono::system_clock::time_point time);

// A row of a table for each of `rows`, its columns as wide as the widest of it; the first row has the
// titles. Empty when there is no other.
std::string Table(const std::vector<std::vector<std::string>>& rows);

}  // namespace arap::cli
