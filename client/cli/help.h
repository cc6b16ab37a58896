// The help of arapctl: what a command takes and examples of it, as its help, its man page and the
// completion of shells show it. All of them are made of the tree of CLI11.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace arap::cli {

struct OptionText {
  std::string names;  // "-h,--help", or the name of a positional
  std::string value;  // "FILE.csv", "a|b|c"; empty: it takes none
  std::string help;
  bool positional = false;
  bool required = false;
};

struct OptionSection {
  std::string title;  // "Server: which server to use; one of these"
  std::vector<OptionText> options;
};

// The arguments, then the options of the command itself, then each group of options. Sections without
// options are left out.
std::vector<OptionSection> SectionsOf(const CLI::App& command);

// The commands under one, in their order; options in groups are none.
std::vector<const CLI::App*> CommandsOf(const CLI::App& command);

// "arapctl token add [OPTIONS]"; `name` is that of the command with those above it.
std::string UsageOf(const CLI::App& command, const std::string& name);

// The table of exit codes, a line for each, each beginning with two spaces.
std::string ExitCodeLines();

// Lines of at most 80 columns that are broken between words; headings are bold on a terminal.
class Help : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* command, std::string name,
                        CLI::AppFormatMode mode) const override;
};

struct Example {
  std::string_view command;  // "token add"
  std::string_view lines;    // command lines, each on its own, some with "  # what it is for"
};

std::span<const Example> Examples();

// Puts them below the help of the commands under `app`.
void AddExamples(CLI::App& app);

}  // namespace arap::cli
