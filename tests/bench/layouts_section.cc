#include "tests/bench/layouts_section.h"

#include <array>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "arap/core/flattener.h"
#include "tests/bench/samples.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kRounds = 5;
constexpr const char* kLine = "{:24}{:>9}{:>12}{:>11}{:>9}{:>12}{:>13}{:>11}{:>7}{:>11}\n";

struct Way {
  std::string figure;
  FlattenOptions options;
  int rounds = kRounds;
  Samples samples{};
  std::optional<Flattening> flat{};
};

Way WayOf(const char* figure, int refine, double stop, bool injective, int rounds) {
  FlattenOptions options = ArapOptions();
  options.refine = refine;
  options.refine_stop = stop;
  options.injective = injective;
  options.cut.auto_cut = true;
  return {figure, options, rounds};
}

std::string Cell(const Json& value, int digits) {
  return value.is_null() ? "-" : fmt::format("{:.{}f}", value.get<double>(), digits);
}

}  // namespace

Json MeasureLayouts(const SurfaceMesh& mesh) {
  std::array<Way, 4> ways{WayOf("refine20_ms", 20, 1e-6, false, kRounds),
                          WayOf("converged_ms", kServiceRefine, kServiceRefineStop, false, kRounds),
                          WayOf("best_ms", kMaxFlattenRefine, 0, false, 1),
                          WayOf("injective_ms", kServiceRefine, kServiceRefineStop, true, kRounds)};
  for (int round = 0; round < kRounds; ++round) {
    for (Way& way : ways) {
      if (round >= way.rounds) continue;
      auto flat = way.samples.Time([&] { return Flatten(mesh, way.options); });
      if (flat) way.flat.emplace(std::move(*flat));
    }
  }
  const auto& [twenty, converged, best, injective] = ways;
  Json figures;
  figures["vertices"] = mesh.vertices.size();
  for (const Way& way : ways) {
    figures[way.figure] = way.flat ? Json(way.samples.Median() * 1e-3) : Json(nullptr);
  }
  for (const char* figure : {"converged_over_20", "energy_over_best", "symmetric_dirichlet"}) {
    figures[figure] = nullptr;
  }
  if (twenty.flat && converged.flat) {
    figures["converged_over_20"] = converged.samples.Median() / twenty.samples.Median();
  }
  if (converged.flat && best.flat && best.flat->distortion.arap_energy > 0) {
    figures["energy_over_best"] =
        converged.flat->distortion.arap_energy / best.flat->distortion.arap_energy;
  }
  if (injective.flat) {
    figures["symmetric_dirichlet"] = injective.flat->distortion.symmetric_dirichlet;
  }
  figures["flipped_before"] = converged.flat ? Json(converged.flat->distortion.flipped) : Json();
  return figures;
}

void PrintLayoutsHead() {
  fmt::print("\nhard surfaces; ms\n");
  fmt::print(kLine, "", "vertices", "2 steps+20", "converged", "over 20", "until none",
             "energy over", "injective", "flips", "Dirichlet");
}

void PrintLayouts(const std::string& name, const Json& figures) {
  fmt::print(kLine, name, figures["vertices"].get<std::size_t>(), Cell(figures["refine20_ms"], 1),
             Cell(figures["converged_ms"], 1), Cell(figures["converged_over_20"], 2),
             Cell(figures["best_ms"], 0), Cell(figures["energy_over_best"], 6),
             Cell(figures["injective_ms"], 1), Cell(figures["flipped_before"], 0),
             Cell(figures["symmetric_dirichlet"], 4));
}

}  // namespace arap::bench
