// Examples of every command, as its help and its man page show them.
#pragma once

#include <span>
#include <string_view>

#include <CLI/CLI.hpp>

namespace arap::cli {

struct Example {
  std::string_view command;  // "token add"
  std::string_view lines;    // command lines, each on its own, some with "  # what it is for"
};

std::span<const Example> Examples();

// Puts them below the help of the commands under `app`.
void AddExamples(CLI::App& app);

}  // namespace arap::cli
