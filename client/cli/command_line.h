// The command line of arapctl as a whole: its commands, and what happens to its words.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/cli/commands/commands.h"

namespace arap::cli {

// The tree of commands with their help. Parsing it sets `run`, which it refers to.
std::unique_ptr<CLI::App> MakeCommandLine(const std::string& version, Run& run);

// Does what the words after "arapctl" say; answers the exit code. What they leave open is taken from the
// environment and the config file (settings.h).
int RunCommandLine(std::vector<std::string> words, const std::string& version);

}  // namespace arap::cli
