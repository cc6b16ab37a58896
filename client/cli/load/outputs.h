// Where a run is told, and how the command ends for it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arap/base/result.h"
#include "client/cli/exit_code.h"
#include "client/cli/load/results.h"
#include "client/cli/load/threshold.h"

namespace arap::cli {

struct LoadOutputs {
  std::string json, csv, html;  // files, "-" for standard output; empty: none
  std::vector<Threshold> thresholds;

  // Whether standard output is for one of the files.
  bool TakeStandardOutput() const;
};

// --json, --csv, --html, --threshold.
void AddLoadOutputs(CLI::App& command, LoadOutputs& outputs);
// --threshold, which may be given again; `parse` says what it takes.
void AddThresholds(CLI::App& command, std::vector<Threshold>& thresholds,
                   Result<Threshold> (*parse)(std::string_view), const std::string& help);

// kFailed when nothing was answered, when answers were wrong, or when there were errors; kMissed when a
// threshold was. What a threshold speaks of, errors or wrong answers, is its alone: "errors<1%" lets some
// pass.
Exit VerdictOf(const LoadResults& results, std::span<const Judgement> judgements);

// Prints the run and what its thresholds found, writes the files, and says on standard error why it has
// failed. Answers the exit code.
int TellLoad(const LoadResults& results, const LoadOutputs& outputs);

}  // namespace arap::cli
