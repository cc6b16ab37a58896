#include "client/cli/commands/flatten_report.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/cli/reply.h"

namespace arap::cli {
namespace {

using Json = nlohmann::ordered_json;

Json DistortionJson(const Distortion& d) {
  return {{"arap_energy", d.arap_energy},
          {"symmetric_dirichlet", d.symmetric_dirichlet},
          {"area_ratio", d.area_ratio},
          {"mean_stretch_percent", d.mean_stretch_percent},
          {"max_stretch_percent", d.max_stretch_percent},
          {"mean_compression_percent", d.mean_compression_percent},
          {"max_compression_percent", d.max_compression_percent},
          {"mean_angle_degrees", d.mean_angle_degrees},
          {"max_angle_degrees", d.max_angle_degrees},
          {"flipped", d.flipped},
          {"scale", 1.0},
          {"worst_triangle", d.worst_triangle}};
}

double LoopLength(const std::vector<std::uint32_t>& loop, const std::vector<Complex>& uv) {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const std::size_t a = loop[i], b = loop[(i + 1) % loop.size()];
    length += std::hypot(uv[a].real() - uv[b].real(), uv[a].imag() - uv[b].imag());
  }
  return length;
}

Json SizeJson(const Bounds& box) { return {box.width(), box.height()}; }

Json EndJson(RefineEnd end) {
  switch (end) {
    case RefineEnd::kNotRefined:
      return nullptr;
    case RefineEnd::kConverged:
      return "converged";
    case RefineEnd::kLimit:
      return "limit";
  }
  return nullptr;
}

Json ChartJson(const FlatChart& chart, const Flattening& flat) {
  Json boundaries = Json::array();
  for (const auto& loop : chart.loops) {
    boundaries.push_back({{"positions", loop.size()}, {"length", LoopLength(loop, flat.uv)}});
  }
  return {{"triangles", chart.triangles},
          {"boundaries", boundaries},
          {"boundary_crossings", chart.crossings},
          {"anchors", chart.anchors},
          {"refinements", chart.refinements},
          {"refine_end", EndJson(chart.refine_end)},
          {"distortion", DistortionJson(chart.distortion)}};
}

}  // namespace

Json ReportJson(const SurfaceMesh& mesh, const client::FlatSurface& answer, const Pattern& pattern,
                bool sigma) {
  const Flattening& flat = answer.flat;
  Json charts = Json::array();
  for (std::size_t c = 0; c < flat.charts.size(); ++c) {
    Json chart = ChartJson(flat.charts[c], flat);
    const PatternPiece& piece = pattern.pieces[c];
    if (!piece.name.empty()) chart["name"] = piece.name;
    chart["size_mm"] = SizeJson(piece.box);
    charts.push_back(std::move(chart));
  }
  Json cuts = Json::array();
  for (const auto& [from, to] : flat.cuts) cuts.push_back({from, to});
  Json anchors = Json::array();
  if (!flat.charts.empty()) {
    for (const std::uint32_t anchor : flat.charts.front().anchors) {
      anchors.push_back(flat.source[anchor]);
    }
  }
  Json json{{"vertices", mesh.vertices.size()},
            {"triangles", mesh.triangles.size()},
            {"flat_positions", flat.uv.size()},
            {"distortion", DistortionJson(flat.distortion)},
            {"boundary_overlaps", flat.overlaps},
            {"sheet_mm", SizeJson(pattern.Box())},
            {"anchor_vertices", anchors},
            {"charts", charts},
            {"cut_edges", cuts},
            {"auto_cut_count", flat.auto_cuts},
            {"left_out_triangles", flat.degenerate},
            {"warnings", WarningsJson(flat.warnings)},
            {"surface_cached", answer.surface_cached},
            {"queue_micros", answer.queue_micros},
            {"solve_micros", answer.solve_micros}};
  if (sigma) {
    Json& values = json["singular_values"] = Json::array();
    for (const auto& [s1, s2] : flat.singular_values) values.push_back({s1, s2});
  }
  return json;
}

Json ComparisonJson(const std::vector<ComparisonPanel>& panels) {
  Json json = Json::array();
  for (const ComparisonPanel& panel : panels) {
    Json& one = json.emplace_back(Json{{"label", panel.label}});
    if (panel.flat.uv.empty()) {
      one["error"] = panel.lines.front();
    } else {
      one["distortion"] = DistortionJson(panel.flat.distortion);
    }
  }
  return json;
}

std::string FormatTable(const std::vector<ComparisonPanel>& panels) {
  std::string out = fmt::format("{:<28}{:>8}{:>10}{:>12}{:>13}{:>10}{:>10}\n", "", "flipped",
                                "area", "stretch %", "compress. %", "angle °", "ARAP");
  for (const ComparisonPanel& panel : panels) {
    if (panel.flat.uv.empty()) {
      fmt::format_to(std::back_inserter(out), "{:<28}{}\n", panel.label, panel.lines.front());
      continue;
    }
    const Distortion& d = panel.flat.distortion;
    fmt::format_to(std::back_inserter(out),
                   "{:<28}{:>8}{:>10.4f}{:>12.3f}{:>13.3f}{:>10.3f}{:>10.4g}\n", panel.label,
                   d.flipped, d.area_ratio, d.mean_stretch_percent, d.mean_compression_percent,
                   d.mean_angle_degrees, d.arap_energy);
  }
  return out;
}

}  // namespace arap::cli
