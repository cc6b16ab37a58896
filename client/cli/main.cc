// arapctl: the command line of arapd.
#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>

#include "client/cli/commands/commands.h"

int main(int argc, char** argv) {
  CLI::App app("Deforms and flattens meshes with an arapd server.", "arapctl");
  app.set_version_flag("--version", "arapctl " ARAP_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 success; 1 the server or the work failed; 2 the command line is wrong.\n"
      "`arapctl COMMAND --help` explains a command.");

  arap::cli::Run run;
  arap::cli::AddInfo(app, run);
  arap::cli::AddBake(app, run);
  arap::cli::AddDrag(app, run);
  arap::cli::AddFlatten(app, run);
  arap::cli::AddMesh(app, run);
  arap::cli::AddLoad(app, run);
  arap::cli::AddToken(app, run);
  arap::cli::AddSample(app, run);
  arap::cli::AddFigures(app, run);
  try {
    auto words = arap::cli::Joined({argv + 1, argv + argc});
    // CLI11 takes the words from the end.
    std::reverse(words.begin(), words.end());
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    // --help and --version come here too, as success.
    return app.exit(error) == 0 ? arap::cli::kOk : arap::cli::kUsage;
  }
  return run();
}
