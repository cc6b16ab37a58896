// arapctl help, completion and man: what the command line says of itself.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "client/cli/commands/commands.h"
#include "client/cli/help.h"
#include "client/cli/report.h"
#include "client/cli/shell/completion.h"
#include "client/cli/shell/manual.h"
#include "core/base/try.h"
#include "core/files/text_file.h"

namespace arap::cli {
namespace {

struct ManOptions {
  std::vector<std::string> command;
  std::string out;
};

// The whole tree is there only when the command runs.
Status WriteManPages(const CLI::App& app, const std::string& version, const ManOptions& options) {
  if (!options.out.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.out, error);
    for (const ManPage& page : ManPages(app, version)) {
      CHECK_OK(WriteTextFile(fmt::format("{}/{}.1", options.out, page.name), page.text));
    }
    return {};
  }
  const CLI::App* command = &app;
  for (const std::string& word : options.command) {
    const CLI::App* inner = nullptr;
    for (const CLI::App* one : CommandsOf(*command)) {
      if (one->get_name() == word) inner = one;
    }
    if (inner == nullptr) {
      return Fail(FaultKind::kNotFound, fmt::format("There is no command {}.", word));
    }
    command = inner;
  }
  fmt::print("{}", ManPageOf(*command, options.command, version).text);
  return {};
}

}  // namespace

void AddShellCommands(CLI::App& app, Run& run, const std::string& version) {
  const auto words = std::make_shared<std::vector<std::string>>();
  // It is taken for --help before it is parsed; here it is for the list of commands.
  app.add_subcommand("help", "Explain a command")
      ->add_option("COMMAND", *words, "the command: all of its words")
      ->expected(0, -1);

  struct CompletionOptions {
    std::string shell, out = std::string(kStandardStream);
  };
  const auto script = std::make_shared<CompletionOptions>();
  CLI::App* const completion =
      app.add_subcommand("completion", "Print a script that completes words in a shell");
  completion->add_option("SHELL", script->shell, "bash, zsh or fish")
      ->required()
      ->option_text("bash|zsh|fish")
      ->check(CLI::Validator(
          [](std::string& name) {
            return CompletionScript(name).empty()
                       ? "there is no script for " + name + ", only for bash, zsh and fish"
                       : std::string();
          },
          ""));
  completion
      ->add_option("--out", script->out,
                   "write it into this file, whose folder is made; default standard output")
      ->option_text("FILE");
  completion->callback([&run, script] {
    run = [script] {
      std::error_code error;
      std::filesystem::create_directories(std::filesystem::path(script->out).parent_path(), error);
      return ExitCode(WriteTextFile(script->out, CompletionScript(script->shell)));
    };
  });

  const auto options = std::make_shared<ManOptions>();
  CLI::App* const man = app.add_subcommand("man", "Print a man page, or write all of them");
  man->add_option("COMMAND", options->command, "the command: all of its words; default arapctl");
  man->add_option("--out", options->out, "write every page into this folder: arapctl-bake.1 …")
      ->option_text("FOLDER");
  man->callback([&app, &run, options, version] {
    run = [&app, options, version] { return ExitCode(WriteManPages(app, version, *options)); };
  });
}

}  // namespace arap::cli
