// The subcommands. Each adds itself to the command line; when it was chosen, `run` holds its work,
// which answers the exit code.
#pragma once

#include <functional>
#include <memory>

#include <CLI/CLI.hpp>

#include "client/cli/report.h"

namespace arap::cli {

using Run = std::function<int()>;

// When `command` is chosen, `run` does `action` with the options as they were parsed.
template <class Options>
void SetAction(CLI::App& command, Run& run, std::shared_ptr<Options> options,
               Status (*action)(const Options&)) {
  command.callback(
      [&run, options, action] { run = [options, action] { return ExitCode(action(*options)); }; });
}

void AddInfo(CLI::App& app, Run& run);
void AddBake(CLI::App& app, Run& run);
void AddDrag(CLI::App& app, Run& run);
void AddFlatten(CLI::App& app, Run& run);
void AddLoad(CLI::App& app, Run& run);
void AddToken(CLI::App& app, Run& run);
void AddSample(CLI::App& app, Run& run);
void AddFigures(CLI::App& app, Run& run);

}  // namespace arap::cli
