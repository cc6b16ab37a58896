#include "client/cli/commands/option_names.h"

#include <climits>

namespace arap::cli {
namespace {

template <class Variable>
void AddBasis(CLI::App& command, Variable& basis, bool planar, const std::string& help) {
  std::map<std::string, Basis> bases{{"edge", Basis::kEdge},
                                     {"edge-as-published", Basis::kEdgeAsPublished},
                                     {"face", Basis::kFace}};
  if (planar) bases.emplace("vertex", Basis::kVertex);
  AddChoice(command, "--basis", basis, bases, help);
}

template <class Variable>
void AddWeights(CLI::App& command, Variable& weights, const std::string& help) {
  AddChoice<Weights>(command, "--weights", weights,
                     {{"uniform", Weights::kUniform}, {"cotangent", Weights::kCotangent}}, help);
}

}  // namespace

void AddEnergyOptions(CLI::App& command, EnergyOptions& energy) {
  AddBasis(command, energy.basis, /*planar=*/true, "what moves rigidly; default edge");
  AddWeights(command, energy.weights, "of the edges; default uniform");
}

void AddFlattenEnergyOptions(CLI::App& command, std::optional<Basis>& basis,
                             std::optional<Weights>& weights) {
  AddBasis(command, basis, /*planar=*/false, "what moves rigidly, where the method leaves it open");
  AddWeights(command, weights, "of the edges; default cotangent");
}

void AddDeformOptions(CLI::App& command, DeformOptions& options) {
  AddChoice<DeformMode>(command, "--mode", options.mode,
                        {{"rigid", DeformMode::kRigid},
                         {"similarity", DeformMode::kSimilarity},
                         {"baseline", DeformMode::kBaseline}},
                        "what to minimise; default rigid");
  command.add_option("--refine", options.refine, "further iterations of the second step")
      ->check(CLI::Range(0, INT_MAX).description(""))
      ->option_text("N");
}

}  // namespace arap::cli
