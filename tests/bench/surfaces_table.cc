#include "tests/bench/surfaces_table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "arap/core/flattener.h"
#include "core/files/mesh_file.h"
#include "tests/bench/contenders.h"
#include "tests/bench/layout_quality.h"

namespace arap::bench {
namespace {

namespace fs = std::filesystem;

struct Way {
  std::string name;
  FlattenOptions options;
};

FlattenOptions Options(FlattenMethod method, Basis basis, Weights weights, FlattenAnchors anchors,
                       int refine = 0, bool injective = false) {
  FlattenOptions options;
  options.method = method;
  options.energy = {basis, weights, {}};
  options.anchors = anchors;
  options.refine = refine;
  options.refine_stop = 1e-6;
  options.injective = injective;
  options.cut.auto_cut = true;
  options.cut.tolerate_degenerate = true;
  return options;
}

std::vector<Way> Ways() {
  std::vector<Way> ways;
  const auto anchored = [&ways](const std::string& name, FlattenMethod method, Basis basis,
                                Weights weights, std::initializer_list<int> refinements) {
    for (const int refine : refinements) {
      for (const auto& [anchors, called] : {std::pair(FlattenAnchors::kCentreEdge, "centre"),
                                            std::pair(FlattenAnchors::kFarBoundary, "far"),
                                            std::pair(FlattenAnchors::kSpectral, "spectral")}) {
        const std::string more = refine > 0 ? fmt::format(", refine {}", refine) : "";
        ways.push_back({fmt::format("{} {}{}", name, called, more),
                        Options(method, basis, weights, anchors, refine)});
      }
    }
  };
  using enum FlattenMethod;
  anchored("paper's first step", kFirstStep, Basis::kEdgeAsPublished, Weights::kUniform, {0});
  anchored("paper", kArap, Basis::kEdgeAsPublished, Weights::kUniform, {0, 20});
  anchored("EDGE uniform", kArap, Basis::kEdge, Weights::kUniform, {0});
  anchored("EDGE cotangent", kArap, Basis::kEdge, Weights::kCotangent, {0, 20});
  anchored("LSCM", kFirstStep, Basis::kFace, Weights::kCotangent, {0});
  anchored("FACE cotangent", kArap, Basis::kFace, Weights::kCotangent, {0, 5, 20, 100, 1000});
  ways.push_back(
      {"ABF", Options(kAbf, Basis::kFace, Weights::kCotangent, FlattenAnchors::kSpectral)});
  ways.push_back({"ABF, refine 20",
                  Options(kAbf, Basis::kFace, Weights::kCotangent, FlattenAnchors::kSpectral, 20)});
  ways.push_back(
      {"FACE cotangent spectral, refine 20, injective",
       Options(kArap, Basis::kFace, Weights::kCotangent, FlattenAnchors::kSpectral, 20, true)});
  return ways;
}

struct Cell {
  double energy = 0, scaled = 0;  // NaN: a fault
  std::size_t flipped = 0;
  double milliseconds = 0;
};

constexpr const char* kLine = "{:46}{:>12}{:>12}{:>8}{:>10}{:>10}{:>6}{:>10}\n";

Cell MeasureWay(const SurfaceMesh& mesh, const Way& way) {
  const auto flat = Flatten(mesh, way.options);
  if (!flat) {
    fmt::print("{:46}  {}\n", way.name, flat.error().message);
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    return {kNan, kNan, 0, kNan};
  }
  const LayoutQuality quality = QualityOf(mesh, *flat);
  const Distortion& d = quality.distortion;
  int refinements = 0;
  for (const FlatChart& chart : flat->charts) {
    refinements = std::max(refinements, chart.refinements);
  }
  fmt::print(kLine, way.name, fmt::format("{:.5g}", d.arap_energy),
             fmt::format("{:.5g}", quality.scaled_energy),
             fmt::format("{}{}", d.flipped, flat->overlaps ? "*" : ""),
             fmt::format("{:.1f}", d.max_stretch_percent),
             fmt::format("{:.1f}", d.max_compression_percent), refinements,
             fmt::format("{:.1f}", flat->times.total()));
  return {d.arap_energy, quality.scaled_energy, d.flipped, flat->times.total()};
}

// exp of the mean of log(x / best), where developable surfaces, exact up to rounding, are alike.
double MeanRatio(const std::vector<std::vector<Cell>>& surfaces, std::size_t way,
                 double Cell::*figure, double floor) {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& cells : surfaces) {
    double best = std::numeric_limits<double>::infinity();
    for (const Cell& cell : cells) best = std::min(best, cell.*figure + floor);
    const double own = cells[way].*figure + floor;
    if (std::isnan(own)) continue;
    sum += std::log(own / best);
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : std::exp(sum / static_cast<double>(count));
}

void PrintMeans(const std::vector<Way>& ways, const std::vector<std::vector<Cell>>& surfaces) {
  constexpr double kExact = 1e-9;
  fmt::print("\nall {} surfaces: geometric mean of the ratio to the best way of each\n",
             surfaces.size());
  fmt::print("{:46}{:>12}{:>12}{:>8}{:>10}{:>8}\n", "", "energy", "best size", "flips", "ms",
             "faults");
  for (std::size_t w = 0; w < ways.size(); ++w) {
    std::size_t flips = 0, faults = 0;
    for (const auto& cells : surfaces) {
      flips += cells[w].flipped;
      if (std::isnan(cells[w].energy)) ++faults;
    }
    fmt::print("{:46}{:>12.4f}{:>12.4f}{:>8}{:>10.2f}{:>8}\n", ways[w].name,
               MeanRatio(surfaces, w, &Cell::energy, kExact),
               MeanRatio(surfaces, w, &Cell::scaled, kExact), flips,
               MeanRatio(surfaces, w, &Cell::milliseconds, 0), faults);
  }
}

}  // namespace

void PrintSurfacesTable(const std::string& directory) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(directory)) {
    if (entry.path().extension() == ".obj") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  if (files.empty()) Die("no OBJ files in " + directory);
  const std::vector<Way> ways = Ways();
  std::vector<std::vector<Cell>> surfaces;
  for (const fs::path& file : files) {
    const SurfaceMesh mesh = Must(ReadSurfaceMesh(file.string()));
    fmt::print("\n{}, {} vertices, {} triangles (* overlaps itself)\n", file.filename().string(),
               mesh.vertices.size(), mesh.triangles.size());
    fmt::print(kLine, "", "energy", "best size", "flips", "stretch %", "squeeze %", "taken", "ms");
    auto& cells = surfaces.emplace_back();
    for (const Way& way : ways) cells.push_back(MeasureWay(mesh, way));
    std::fflush(stdout);
  }
  PrintMeans(ways, surfaces);
}

}  // namespace arap::bench
