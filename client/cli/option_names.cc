#include "client/cli/option_names.h"

#include <map>
#include <string>

namespace arap::cli {
namespace {

using client::Basis;
using client::DeformMode;
using client::EdgeWeights;

// Help that lists the names alone; the numbers of the enumerators are nobody's business.
template <class Enum>
CLI::Option* AddChoice(CLI::App& command, const std::string& flag, Enum& value,
                       const std::map<std::string, Enum>& names, const std::string& help) {
  std::string choices;
  for (const auto& [name, enumerator] : names) choices += (choices.empty() ? "" : "|") + name;
  return command.add_option(flag, value, help)
      ->transform(CLI::CheckedTransformer(names).description(""))
      ->option_text(choices);
}

}  // namespace

void AddEnergyOptions(CLI::App& command, client::EnergyOptions& energy, bool planar) {
  std::map<std::string, Basis> bases{{"edge", Basis::kEdge},
                                     {"edge-as-published", Basis::kEdgeAsPublished},
                                     {"face", Basis::kFace}};
  if (planar) bases.emplace("vertex", Basis::kVertex);
  AddChoice(command, "--basis", energy.basis, bases, "what moves rigidly; default edge");
  AddChoice<EdgeWeights>(
      command, "--weights", energy.weights,
      {{"uniform", EdgeWeights::kUniform}, {"cotangent", EdgeWeights::kCotangent}},
      planar ? "of the edges; default uniform" : "of the edges; default cotangent");
}

void AddDeformOptions(CLI::App& command, client::DeformOptions& options) {
  AddChoice<DeformMode>(command, "--mode", options.mode,
                        {{"rigid", DeformMode::kRigid},
                         {"similarity", DeformMode::kSimilarity},
                         {"baseline", DeformMode::kBaseline}},
                        "what to minimise; default rigid");
  command.add_option("--refine", options.refine, "further iterations of the second step")
      ->option_text("N");
}

}  // namespace arap::cli
