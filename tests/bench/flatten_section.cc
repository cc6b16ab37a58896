#include "tests/bench/flatten_section.h"

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "arap/core/flattener.h"
#include "core/base/cpu_timer.h"
#include "tests/bench/apart.h"
#include "tests/bench/cgal_parameterizer.h"
#include "tests/bench/contenders.h"
#include "tests/bench/layout_quality.h"

namespace arap::bench {
namespace {

using Json = nlohmann::ordered_json;

// A contender is measured this often, or until it has had this much time.
constexpr int kRounds = 9;
constexpr double kEnoughMilliseconds = 10e3;

struct Contender {
  std::string total;              // the key of its duration
  std::vector<std::string> keys;  // all of what `run` gives
  std::function<Json()> run;      // in a process of its own
};

Json RunOurs(const SurfaceMesh& mesh, const FlattenOptions& options, const std::string& prefix,
             const std::string& total) {
  SurfaceMesh own = mesh;
  const PeakMemory memory;
  const Flattening flat = Must(Flatten(std::move(own), options));
  Json figures;
  figures[prefix + "topology_ms"] = flat.times.topology;
  figures[prefix + "order_ms"] = flat.times.order;
  figures[prefix + "factor_ms"] = flat.times.factor;
  figures[prefix + "solve_ms"] = flat.times.solve;
  figures[total] = flat.times.total();
  const std::string whose = prefix.empty() ? "lscm_" : prefix;
  figures[whose + "peak_bytes"] = memory.Growth();
  const LayoutQuality quality = QualityOf(mesh, flat);
  figures[prefix.empty() ? "lscm_energy" : "arap_energy"] = quality.distortion.arap_energy;
  figures[whose + "scaled_energy"] = quality.scaled_energy;
  figures[whose + "flipped"] = quality.distortion.flipped;
  return figures;
}

Json RunCgal(const SurfaceMesh& mesh, CgalMethod method, const std::string& prefix) {
  CgalParameterizer cgal(mesh);
  const PeakMemory memory;
  CpuTimer timer;
  const std::string error = cgal.Run(method);
  Json figures;
  figures[prefix + "ms"] = timer.Lap();
  figures[prefix + "peak_bytes"] = memory.Growth();
  const LayoutQuality quality = QualityOf(mesh, cgal.uv());
  figures[prefix + "energy"] = quality.distortion.arap_energy;
  figures[prefix + "scaled_energy"] = quality.scaled_energy;
  figures[prefix + "flipped"] = quality.distortion.flipped;
  if (!error.empty()) figures[prefix + "error"] = error;
  return figures;
}

FlattenOptions Lscm() {
  FlattenOptions options;
  options.method = FlattenMethod::kFirstStep;
  options.energy = {Basis::kFace, Weights::kCotangent, {}};
  options.anchors = FlattenAnchors::kCentreEdge;
  return options;
}

FlattenOptions Refined() {
  FlattenOptions options;
  options.method = FlattenMethod::kArap;
  options.energy = {Basis::kFace, Weights::kCotangent, {}};
  options.refine = 20;
  return options;
}

std::vector<std::string> Keys(std::vector<std::string> keys, const std::string& prefix) {
  for (std::string& key : keys) key = prefix + key;
  return keys;
}

std::vector<Contender> Contenders(const SurfaceMesh& mesh) {
  std::vector<Contender> all{
      {"total_ms",
       {"topology_ms", "order_ms", "factor_ms", "solve_ms", "total_ms", "lscm_peak_bytes",
        "lscm_energy", "lscm_scaled_energy", "lscm_flipped"},
       [&mesh] { return RunOurs(mesh, Lscm(), "", "total_ms"); }},
      {"refine20_ms",
       {"refine20_topology_ms", "refine20_order_ms", "refine20_factor_ms", "refine20_solve_ms",
        "refine20_ms", "refine20_peak_bytes", "arap_energy", "refine20_scaled_energy",
        "refine20_flipped"},
       [&mesh] { return RunOurs(mesh, Refined(), "refine20_", "refine20_ms"); }}};
  if (!CgalParameterizer::Available()) return all;
  for (const auto& [method, prefix] : {std::pair(CgalMethod::kLscm, std::string("cgal_lscm_")),
                                       std::pair(CgalMethod::kArap, std::string("cgal_arap_"))}) {
    all.push_back(
        {prefix + "ms", Keys({"ms", "peak_bytes", "energy", "scaled_energy", "flipped"}, prefix),
         [&mesh, method = method, prefix = prefix] { return RunCgal(mesh, method, prefix); }});
  }
  return all;
}

// Of every figure the median over the rounds.
Json Medians(const std::vector<Json>& rounds) {
  Json result;
  for (const auto& [key, first] : rounds.front().items()) {
    if (!first.is_number()) {
      result[key] = first;
      continue;
    }
    std::vector<Json> values;
    for (const Json& round : rounds) values.push_back(round[key]);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end(), [](const Json& a, const Json& b) {
      return a.get<double>() < b.get<double>();
    });
    result[key] = *middle;
  }
  return result;
}

std::string Cell(const Json& figures, const std::string& key, double unit, int digits) {
  if (!figures.contains(key)) return "";
  if (figures[key].is_null()) return "-";
  const double value = figures[key].get<double>() / unit;
  return fmt::format("{:.{}f}", value,
                     digits < 0 ? (value < 10    ? 2
                                   : value < 100 ? 1
                                                 : 0)
                                : digits);
}

std::string Ratio(const Json& figures, const std::string& theirs, const std::string& ours) {
  if (!figures.contains(theirs) || figures[theirs].is_null() || figures[ours].is_null()) return "";
  return fmt::format("{:.1f}", figures[theirs].get<double>() / figures[ours].get<double>());
}

}  // namespace

Json MeasureFlatten(const SurfaceMesh& mesh, double budget) {
  const std::vector<Contender> contenders = Contenders(mesh);
  std::vector<std::vector<Json>> rounds(contenders.size());
  std::vector<double> spent(contenders.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      if (spent[c] >= kEnoughMilliseconds) continue;
      const auto figures = RunApart(budget, contenders[c].run);
      if (figures) {
        spent[c] += (*figures)[contenders[c].total].get<double>();
        rounds[c].push_back(*figures);
      } else {
        spent[c] = kEnoughMilliseconds;
      }
    }
  }
  Json result;
  result["vertices"] = mesh.vertices.size();
  result["triangles"] = mesh.triangles.size();
  for (std::size_t c = 0; c < contenders.size(); ++c) {
    if (rounds[c].empty()) {
      for (const std::string& key : contenders[c].keys) result[key] = nullptr;
    } else {
      result.update(Medians(rounds[c]));
    }
  }
  result["peak_bytes"] = std::max(result["lscm_peak_bytes"], result["refine20_peak_bytes"]);
  return result;
}

void PrintFlatten(const Json& figures, double budget) {
  const bool cgal = CgalParameterizer::Available();
  fmt::print("\nbumpy cap, {} vertices, {} triangles\n", figures["vertices"].get<std::size_t>(),
             figures["triangles"].get<std::size_t>());
  fmt::print("{:28}{:>10}{:>12}{:>12}{:>14}\n", "", "LSCM", "2 steps+20", cgal ? "CGAL LSCM" : "",
             cgal ? "CGAL ARAP" : "");
  const auto row = [&](const char* what, double unit, int digits, const std::string& lscm,
                       const std::string& refined, const std::string& theirs) {
    fmt::print("{:28}{:>10}{:>12}{:>12}{:>14}\n", what, Cell(figures, lscm, unit, digits),
               Cell(figures, refined, unit, digits),
               Cell(figures, "cgal_lscm_" + theirs, unit, digits),
               Cell(figures, "cgal_arap_" + theirs, unit, digits));
  };
  row("checks, cuts, charts, ms", 1, -1, "topology_ms", "refine20_topology_ms", "none");
  row("order, ms", 1, -1, "order_ms", "refine20_order_ms", "none");
  row("factors, ms", 1, -1, "factor_ms", "refine20_factor_ms", "none");
  row("the rest, ms", 1, -1, "solve_ms", "refine20_solve_ms", "none");
  row("all, ms", 1, -1, "total_ms", "refine20_ms", "ms");
  row("peak memory, MiB", 1 << 20, 0, "lscm_peak_bytes", "refine20_peak_bytes", "peak_bytes");
  row("ARAP energy", 1, 6, "lscm_energy", "arap_energy", "energy");
  row("ARAP energy at best size", 1, 6, "lscm_scaled_energy", "refine20_scaled_energy",
      "scaled_energy");
  row("flipped triangles", 1, 0, "lscm_flipped", "refine20_flipped", "flipped");
  if (!cgal) return;
  fmt::print("CGAL/ours: LSCM {}, ARAP {}\n", Ratio(figures, "cgal_lscm_ms", "total_ms"),
             Ratio(figures, "cgal_arap_ms", "refine20_ms"));
  for (const char* whose : {"cgal_lscm_", "cgal_arap_"}) {
    const std::string prefix(whose);
    if (figures[prefix + "ms"].is_null()) {
      fmt::print("{} took more than {:g} s\n", prefix == "cgal_lscm_" ? "CGAL LSCM" : "CGAL ARAP",
                 budget);
    }
    if (figures.contains(prefix + "error")) {
      fmt::print("{}: {}\n", prefix, figures[prefix + "error"].get<std::string>());
    }
  }
}

}  // namespace arap::bench
