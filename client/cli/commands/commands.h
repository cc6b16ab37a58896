// The subcommands, and what their command lines share. Each adds itself to the command line; when it
// was chosen, `run` holds its work, which answers the exit code.
#pragma once

#include <charconv>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "arap/model/energy.h"
#include "arap/model/repair.h"
#include "client/cli/report.h"
#include "core/files/text_file.h"

namespace arap::cli {

using Run = std::function<int()>;

// The words of a command line as CLI11 takes them: of "--weld 0.1" one word is made, because a flag that
// may have a value would take the file after it for one.
std::vector<std::string> Joined(std::vector<std::string> words);

void AddInfo(CLI::App& app, Run& run);
void AddBake(CLI::App& app, Run& run);
void AddDrag(CLI::App& app, Run& run);
void AddFlatten(CLI::App& app, Run& run);
void AddMesh(CLI::App& app, Run& run);
// register, list, show and delete, below `mesh`.
void AddMeshCommands(CLI::App& mesh, Run& run);
void AddSession(CLI::App& app, Run& run);
void AddHandles(CLI::App& app, Run& run);
void AddWatch(CLI::App& app, Run& run);
void AddLoad(CLI::App& app, Run& run);
// compare, below `load`.
void AddLoadCompare(CLI::App& load, Run& run);
void AddToken(CLI::App& app, Run& run);
void AddSample(CLI::App& app, Run& run);
void AddFigures(CLI::App& app, Run& run);
// help, completion and man. `app` has to be there when they run.
void AddShellCommands(CLI::App& app, Run& run, const std::string& version);

// When `command` is chosen, `run` does `action` with the options as they were parsed.
template <class Options>
void SetAction(CLI::App& command, Run& run, std::shared_ptr<Options> options,
               Status (*action)(const Options&)) {
  command.callback(
      [&run, options, action] { run = [options, action] { return ExitCode(action(*options)); }; });
}

// An option whose values have names. Its help lists the names alone, not the numbers that they
// stand for.
template <class Value, class Variable>
CLI::Option* AddChoice(CLI::App& command, const std::string& flag, Variable& value,
                       const std::map<std::string, Value>& names, const std::string& help) {
  std::string choices;
  for (const auto& [name, named] : names) choices += (choices.empty() ? "" : "|") + name;
  return command.add_option(flag, value, help)
      ->transform(CLI::CheckedTransformer(names).description(""))
      ->option_text(choices);
}

// Numbers in a range. Unlike CLI::Range it does not take NaN for a number between.
inline CLI::Validator Between(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) -> std::string {
        double number = 0;
        const char* const end = text.data() + text.size();
        const auto [stop, error] = std::from_chars(text.data(), end, number);
        if (error == std::errc() && stop == end && number >= low && number <= high) return {};
        return fmt::format("{} is not a number from {} to {}", text, low, high);
      },
      "");
}
// A number above 0.
inline CLI::Validator Positive() { return Between(1e-9, 1e9); }

// A file to write. That it can be written is known before there is anything to write: a folder that is
// missing or not ours is a wrong command line. "-" is standard output, for one of them.
inline CLI::Option* AddOutput(CLI::App& command, const std::string& flag, std::string& path,
                              const std::string& help, const std::string& text) {
  return command.add_option(flag, path, help)
      ->check(CLI::Validator(
          [flag](std::string& name) {
            if (name == kStandardStream) {
              return TakeStandardOutput(flag) ? std::string()
                                              : "standard output is for another option already";
            }
            const Status writable = CheckWritable(name);
            return writable ? std::string() : writable.error().message;
          },
          ""))
      ->option_text(text);
}

// --timeout: how long to wait for the server to send something new.
struct Timeout {
  double seconds = 600;

  std::chrono::milliseconds value() const {
    return std::chrono::milliseconds(std::llround(std::ceil(seconds * 1000)));
  }
};
inline void AddTimeout(CLI::App& command, Timeout& timeout) {
  command
      .add_option("--timeout", timeout.seconds,
                  "give up when the server has sent nothing new for so many seconds; default 600")
      ->check(Positive())
      ->option_text("SECONDS");
}

// --basis; surfaces have no vertex basis.
template <class Variable>
void AddBasis(CLI::App& command, Variable& basis, bool planar, const std::string& help) {
  std::map<std::string, Basis> bases{{"edge", Basis::kEdge},
                                     {"edge-as-published", Basis::kEdgeAsPublished},
                                     {"face", Basis::kFace}};
  if (planar) bases.emplace("vertex", Basis::kVertex);
  AddChoice(command, "--basis", basis, bases, help);
}

// --weld, --stitch, --drop-duplicates.
void AddRepairs(CLI::App& command, RepairOptions& repairs);

// --weights.
template <class Variable>
void AddWeights(CLI::App& command, Variable& weights, const std::string& help) {
  AddChoice<Weights>(command, "--weights", weights,
                     {{"uniform", Weights::kUniform}, {"cotangent", Weights::kCotangent}}, help);
}

}  // namespace arap::cli
