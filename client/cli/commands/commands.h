// The subcommands, and what their command lines share. Each adds itself to the command line; when it
// was chosen, `run` holds its work, which answers the exit code.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "arap/model/deform.h"
#include "arap/model/energy.h"
#include "arap/model/repair.h"
#include "client/cli/connect/connection.h"
#include "client/cli/report.h"

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
void AddInitTls(CLI::App& app, Run& run);
void AddPlan(CLI::App& app, Run& run);
void AddSample(CLI::App& app, Run& run);
void AddFigures(CLI::App& app, Run& run);
// help, completion and man. `app` has to be there when they run.
void AddShellCommands(CLI::App& app, Run& run, const std::string& version);

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
CLI::Validator Between(double low, double high);
// A number above 0.
CLI::Validator Positive();

// A file to write. That it can be written is known before there is anything to write: a folder that is
// missing or not ours is a wrong command line. "-" is standard output, for one of them.
CLI::Option* AddOutput(CLI::App& command, const std::string& flag, std::string& path,
                       const std::string& help, const std::string& text);

// --timeout: how long to wait for the server to send something new.
struct Timeout {
  double seconds = 600;

  std::chrono::milliseconds value() const;
};
void AddTimeout(CLI::App& command, Timeout& timeout);

// What the commands on things of a server have in common: which server, whose session, what is named.
struct NamedOptions {
  ServerFlags server;
  Timeout timeout;
  bool json = false;
  std::string name;  // "SESSION", or "SESSION/NAME"

  std::string session() const { return name.substr(0, name.find('/')); }
  // Empty without one.
  std::string part() const {
    const std::size_t slash = name.find('/');
    return slash == std::string::npos ? std::string() : name.substr(slash + 1);
  }
  client::CallOptions call() const { return {timeout.value()}; }
};

// The server and the timeout, and where `shape` is not empty the name: "SESSION", "SESSION/MESH" or
// "SESSION/[MESH]", whose second part may be left out.
void AddNamed(CLI::App& command, NamedOptions& options, const std::string& shape,
              const std::string& help);

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

// --measure-every: which shapes of a stream or track are measured.
void AddMeasureEvery(CLI::App& command, DeformOptions& deform);

// --weights.
template <class Variable>
void AddWeights(CLI::App& command, Variable& weights, const std::string& help) {
  AddChoice<Weights>(command, "--weights", weights,
                     {{"uniform", Weights::kUniform}, {"cotangent", Weights::kCotangent}}, help);
}

}  // namespace arap::cli
