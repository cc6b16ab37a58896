#include "client/cli/commands/option_names.h"

namespace arap::cli {
namespace {

using client::Basis;
using client::DeformMode;
using client::EdgeWeights;

void AddBasis(CLI::App& command, Basis& basis, bool planar, const std::string& help) {
  std::map<std::string, Basis> bases{{"edge", Basis::kEdge},
                                     {"edge-as-published", Basis::kEdgeAsPublished},
                                     {"face", Basis::kFace}};
  if (planar) bases.emplace("vertex", Basis::kVertex);
  AddChoice(command, "--basis", basis, bases, help);
}

void AddWeights(CLI::App& command, EdgeWeights& weights, const std::string& help) {
  AddChoice<EdgeWeights>(
      command, "--weights", weights,
      {{"uniform", EdgeWeights::kUniform}, {"cotangent", EdgeWeights::kCotangent}}, help);
}

}  // namespace

void AddEnergyOptions(CLI::App& command, client::EnergyOptions& energy) {
  AddBasis(command, energy.basis, /*planar=*/true, "what moves rigidly; default edge");
  AddWeights(command, energy.weights, "of the edges; default uniform");
}

void AddFlattenEnergyOptions(CLI::App& command, client::EnergyOptions& energy) {
  AddBasis(command, energy.basis, /*planar=*/false,
           "what moves rigidly, where the method leaves it open");
  AddWeights(command, energy.weights, "of the edges; default cotangent");
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
