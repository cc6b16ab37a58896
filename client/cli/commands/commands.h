// The subcommands. Each adds itself to the command line; when it was chosen, `run` holds its work,
// which answers the exit code.
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace arap::cli {

inline constexpr int kOk = 0;
inline constexpr int kFailed = 1;  // the server or the work failed; standard error says how
inline constexpr int kUsage = 2;   // the command line is wrong

using Run = std::function<int()>;

void AddInfo(CLI::App& app, Run& run);
void AddBake(CLI::App& app, Run& run);
void AddDrag(CLI::App& app, Run& run);
void AddFlatten(CLI::App& app, Run& run);
void AddLoad(CLI::App& app, Run& run);
void AddToken(CLI::App& app, Run& run);
void AddSample(CLI::App& app, Run& run);
void AddFigures(CLI::App& app, Run& run);

}  // namespace arap::cli
