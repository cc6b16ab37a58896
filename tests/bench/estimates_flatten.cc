// Surfaces laid flat beside their estimates.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "arap/core/flattener.h"
#include "tests/bench/bumpy_cap.h"
#include "tests/bench/contenders.h"
#include "tests/bench/estimated_cell.h"
#include "tests/bench/estimates_section.h"
#include "tests/support/meshes.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRowBudget = 600;                  // seconds
constexpr std::size_t kMillionTriangles = 990'000;  // of these a few ways, once

// Bumpy sheets of n × n cells beside each other, numbered row by row.
SurfaceMesh BumpySheets(std::uint32_t count, std::uint32_t n) {
  SurfaceMesh mesh;
  for (std::uint32_t k = 0; k < count; ++k) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t i = 0; i <= n; ++i) {
      for (std::uint32_t j = 0; j <= n; ++j) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
        const double height = u * (1 - u) + 0.05 * std::sin(9 * u) * std::cos(7 * v);
        mesh.vertices.push_back({1.5 * k + u, v, height});
      }
    }
    for (Triangle t : testing::GridTriangles(n, n, [](auto, auto) { return false; })) {
      for (std::uint32_t& v : t) v += first;
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

FlattenOptions Refined(FlattenOptions options, int refine, double stop) {
  options.refine = refine;
  options.refine_stop = stop;
  return options;
}

FlattenOptions FromCentreEdge(FlattenOptions options) {
  options.anchors = FlattenAnchors::kCentreEdge;
  return options;
}

// Pins all over the chart of the first vertices, where the options without them lay it.
FlattenOptions WithPins(const SurfaceMesh& mesh, FlattenOptions options, std::uint32_t chart) {
  const Flattening free = Must(Flatten(mesh, options));
  for (std::uint32_t k = 0; k < 8; ++k) {
    const std::uint32_t v = k * (chart / 8) + chart / 16;
    options.pins.push_back({v, 1.02 * free.uv[v], k % 2 == 0 ? 0.0 : 10.0});
  }
  return options;
}

const std::vector<std::string>& FlattenColumns() {
  static const std::vector<std::string> kColumns{
      "ARAP",         "two steps",        "LSCM",       "LSCM, centre edge",
      "ABF",          "first step, EDGE", "ARAP, EDGE", "EDGE, spectral",
      "ARAP, 8 pins", "ARAP, kept",       "LSCM, kept"};
  return kColumns;
}

// `chart`: vertices of each.
Json FlattenCells(const SurfaceMesh& mesh, std::uint32_t chart) {
  // What the libraries take once is taken.
  Must(Flatten(BumpySheets(1, 20), AbfOptions()));
  const bool million = mesh.triangles.size() >= kMillionTriangles;
  Json cells = Json::object();
  const auto lay = [&](const char* column, const FlattenOptions& options) {
    const FlattenCost cost = EstimateFlatten(SizeOf(mesh, options.cut), options);
    const auto work = [&] { return Must(Flatten(mesh, options)); };
    cells[column] = MeasureCell(cost.milliseconds, cost.bytes, work, million ? 1 : 2);
  };
  const auto keep = [&](const char* column, const FlattenOptions& options) {
    const FlattenCost cost = EstimateFlatten(SizeOf(mesh, options.cut), options, true);
    cells[column] = MeasureCell(cost.milliseconds, cost.bytes, [&] {
      auto surface = Must(Prepare(mesh, options.cut));
      Must(Flatten(*surface, options));
      return surface;
    });
  };
  lay("ARAP", ArapOptions());
  lay("LSCM", LscmOptions());
  lay("ABF", AbfOptions());
  lay("first step, EDGE", FirstStepOptions());
  if (million) return cells;
  lay("two steps", Refined(ArapOptions(), 0, 0));
  lay("LSCM, centre edge", FromCentreEdge(LscmOptions()));
  lay("ARAP, EDGE", ArapOptions(Basis::kEdge));
  FlattenOptions spectral = FirstStepOptions();
  spectral.anchors = FlattenAnchors::kSpectral;
  lay("EDGE, spectral", spectral);
  if (chart > 100) lay("ARAP, 8 pins", WithPins(mesh, ArapOptions(), chart));
  keep("ARAP, kept", ArapOptions());
  keep("LSCM, kept", LscmOptions());
  return cells;
}

struct SurfaceRow {
  std::string name;
  std::uint32_t charts, cells;  // cells along the side of a chart; 0: a bumpy cap
  std::size_t triangles = 0;
};

}  // namespace

Json MeasureFlattenEstimates(bool million) {
  const std::vector<SurfaceRow> large{{"1M, 1", 1, 707}};
  const std::vector<SurfaceRow> grid{{"1k, 1", 1, 22},
                                     {"5k, 1", 1, 50},
                                     {"30k, 1", 1, 122},
                                     {"150k, 1", 1, 274},
                                     {"150k, 20", 20, 61},
                                     {"50k, 1000", 1000, 5},
                                     {"50k, 25k", 25000, 1},
                                     {"cap, 10k, 1", 1, 0, 10'000},
                                     {"cap, 100k, 1", 1, 0, 100'000}};
  PrintEstimatesHead("triangles, charts", FlattenColumns());
  Json all = Json::object();
  for (const SurfaceRow& row : million ? large : grid) {
    const auto cells = RunApart(kRowBudget, [&] {
      const SurfaceMesh mesh =
          row.cells > 0 ? BumpySheets(row.charts, row.cells) : BumpyCap(row.triangles);
      return FlattenCells(mesh, static_cast<std::uint32_t>(mesh.vertices.size() / row.charts));
    });
    if (!cells) continue;
    all[row.name] = *cells;
    PrintEstimates(row.name, FlattenColumns(), *cells);
  }
  return all;
}

}  // namespace arap::bench
