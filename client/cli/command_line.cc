#include "client/cli/command_line.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "client/cli/exit_code.h"
#include "client/cli/help.h"
#include "client/cli/reply.h"
#include "client/cli/report.h"
#include "client/cli/settings.h"
#include "client/cli/shell/completion.h"
#include "client/cli/terminal.h"

namespace arap::cli {
namespace {

// The command that the first words name, and how many they are.
struct Chosen {
  const CLI::App* command;
  std::size_t depth = 0;
  std::string name = "arapctl";
};

Chosen Choose(const CLI::App& app, std::span<const std::string> words) {
  Chosen chosen{&app};
  for (const std::string& word : words) {
    const std::vector<const CLI::App*> commands = CommandsOf(*chosen.command);
    const auto named = std::find_if(commands.begin(), commands.end(),
                                    [&](const CLI::App* one) { return one->get_name() == word; });
    if (named == commands.end()) break;
    chosen.command = *named;
    ++chosen.depth;
    chosen.name += " " + word;
  }
  return chosen;
}

int Misused(const Chosen& chosen, std::string_view what, bool json) {
  if (json) fmt::print("{}", JsonText(UsageErrorJson(std::string(what))));
  fmt::print(stderr, "{} {}\n", Styled(STDERR_FILENO, Look::kBad, chosen.name + ":"),
             Printable(what));
  const std::string path = chosen.name.substr(std::string_view("arapctl").size());
  fmt::print(stderr, "`arapctl help{}` explains.\n", path);
  return kUsage;
}

bool AsksForHelp(std::span<const std::string> words) {
  return std::any_of(words.begin(), words.end(),
                     [](const std::string& word) { return word == "--help" || word == "-h"; });
}

std::vector<std::string> NamesOf(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CLI::App* one : commands) names.push_back(one->get_name());
  return names;
}

std::vector<std::string> LongOptionsOf(const CLI::App& command) {
  std::vector<std::string> names;
  for (const OptionSection& section : SectionsOf(command)) {
    for (const OptionText& option : section.options) {
      if (!option.positional) names.push_back(option.names.substr(option.names.rfind(',') + 1));
    }
  }
  return names;
}

// What no command and no option is called, with what may have been meant. The parser of the command line
// would say less.
std::optional<std::string> FindUnknown(const Chosen& chosen, std::span<const std::string> words) {
  const std::span<const std::string> rest = words.subspan(chosen.depth);
  const std::vector<const CLI::App*> commands = CommandsOf(*chosen.command);
  const bool wanted = chosen.command->get_require_subcommand_min() > 0;
  if (wanted && !rest.empty() && !rest.front().starts_with('-')) {
    return fmt::format("there is no command '{}'{}", rest.front(),
                       DidYouMean(rest.front(), NamesOf(commands)));
  }
  bool is_value = false;
  for (const std::string& word : rest) {
    if (word == "--") break;
    if (std::exchange(is_value, false) || !word.starts_with("--")) continue;
    const std::string name = word.substr(0, word.find('='));
    const CLI::Option* const option = chosen.command->get_option_no_throw(name);
    if (option == nullptr) {
      return fmt::format("there is no option {}{}", name,
                         DidYouMean(name, LongOptionsOf(*chosen.command)));
    }
    is_value = name == word && option->get_expected_min() > 0 && option->get_type_size() > 0;
  }
  return std::nullopt;
}

bool Has(std::span<const std::string> words, std::string_view flag) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return word == flag || word.starts_with(std::string(flag) + "=");
  });
}

}  // namespace

std::unique_ptr<CLI::App> MakeCommandLine(const std::string& version, Run& run) {
  auto app =
      std::make_unique<CLI::App>("Deforms and flattens meshes with an arapd server.", "arapctl");
  app->formatter(std::make_shared<Help>());
  app->set_version_flag("--version", "arapctl " + version, "print the version");
  app->set_help_flag("-h,--help", "print this help");
  app->require_subcommand(1);
  AddInfo(*app, run);
  AddBake(*app, run);
  AddDrag(*app, run);
  AddFlatten(*app, run);
  AddMesh(*app, run);
  AddSession(*app, run);
  AddHandles(*app, run);
  AddWatch(*app, run);
  AddLoad(*app, run);
  AddToken(*app, run);
  AddPlan(*app, run);
  AddInitTls(*app, run);
  AddSample(*app, run);
  AddFigures(*app, run);
  AddShellCommands(*app, run, version);
  AddExamples(*app);
  std::string footer =
      "`arapctl help COMMAND` explains a command. ARAPCTL_SERVER, or a line `server = ADDRESS` in "
      "~/.config/arapctl/config, says where the server is; `man arapctl` lists what else they "
      "say.\n\nExit codes:\n" +
      ExitCodeLines();
  footer.pop_back();
  app->footer(footer);
  return app;
}

int RunCommandLine(std::vector<std::string> words, const std::string& version) {
  Run run;
  const std::unique_ptr<CLI::App> app = MakeCommandLine(version, run);
  if (words.size() >= 2 && words[0] == kCompleteWord) {
    words.erase(words.begin(), words.begin() + (words[1] == "--" ? 2 : 1));
    fmt::print("{}", FormatCandidates(Complete(*app, words)));
    return kOk;
  }
  // `help X Y` is `X Y --help`.
  if (!words.empty() && words[0] == "help" && !AsksForHelp(words)) {
    words.erase(words.begin());
    words.emplace_back("--help");
  }
  const Chosen chosen = Choose(*app, words);
  // Of drag and load --json names a file.
  const CLI::Option* const json_flag = chosen.command->get_option_no_throw("--json");
  const bool json =
      json_flag != nullptr && json_flag->get_expected_max() == 0 && Has(words, "--json");
  if (const auto unknown = FindUnknown(chosen, words)) return Misused(chosen, *unknown, json);
  std::vector<std::string> settings;
  if (!AsksForHelp(words)) {
    Result<std::vector<std::string>> found = SettingWords(*chosen.command, words);
    if (!found) return Misused(chosen, found.error().message, json);
    settings = std::move(*found);
    words.insert(words.begin() + static_cast<std::ptrdiff_t>(chosen.depth), settings.begin(),
                 settings.end());
    if (chosen.command->get_option_no_throw("--server") != nullptr && !Has(words, "--server") &&
        !Has(words, "--spawn")) {
      return Misused(chosen,
                     "which server? Give --server ADDRESS, or --spawn for a private one; or set "
                     "ARAPCTL_SERVER",
                     json);
    }
  }
  try {
    words = Joined(std::move(words));
    // CLI11 takes the words from the end.
    std::reverse(words.begin(), words.end());
    app->parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, as success.
    if (error.get_exit_code() == 0) return app->exit(error);
    std::string what = error.what();
    for (const std::string& setting : settings) {
      if (what.find(setting.substr(0, setting.find('='))) != std::string::npos) {
        what += fmt::format(" ({} is of the environment or of {})", setting, ConfigPath());
      }
    }
    return Misused(chosen, what, json);
  }
  return run();
}

}  // namespace arap::cli
