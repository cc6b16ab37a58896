// The options of the server under the names that the command line uses.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "arap/model/deform.h"
#include "arap/model/energy.h"

namespace arap::cli {

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

// --basis and --weights for meshes in the plane, and for surfaces, which have no vertex basis.
void AddEnergyOptions(CLI::App& command, EnergyOptions& energy);
void AddFlattenEnergyOptions(CLI::App& command, std::optional<Basis>& basis,
                             std::optional<Weights>& weights);

// --mode and --refine.
void AddDeformOptions(CLI::App& command, DeformOptions& options);

}  // namespace arap::cli
