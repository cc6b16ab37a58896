#include "client/cli/commands/flatten_report.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace arap::cli {
namespace {

using Json = nlohmann::ordered_json;

Json DistortionJson(const client::Distortion& d) {
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
          {"scale", d.scale},
          {"worst_triangle", d.worst_triangle}};
}

double LoopLength(const std::vector<std::uint32_t>& loop, const std::vector<double>& uv) {
  double length = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const std::size_t a = loop[i], b = loop[(i + 1) % loop.size()];
    length += std::hypot(uv[2 * a] - uv[2 * b], uv[2 * a + 1] - uv[2 * b + 1]);
  }
  return length;
}

Json ChartJson(const client::FlatChart& chart, const client::FlatSurface& flat) {
  Json boundaries = Json::array();
  for (const auto& loop : chart.loops) {
    boundaries.push_back({{"positions", loop.size()}, {"length", LoopLength(loop, flat.uv)}});
  }
  return {{"triangles", chart.triangle_count},
          {"boundaries", boundaries},
          {"boundary_crossings", chart.boundary_crossings},
          {"anchors", chart.anchors},
          {"refinements", chart.refinements},
          {"distortion", DistortionJson(chart.distortion)}};
}

}  // namespace

std::string JsonReport(const client::SurfaceMesh& mesh, const client::FlatSurface& flat,
                       bool sigma) {
  Json warnings = Json::array();
  for (const client::Warning& warning : flat.warnings) {
    warnings.push_back({{"kind", warning.kind},
                        {"count", warning.count},
                        {"elements", warning.elements},
                        {"message", warning.message}});
  }
  Json charts = Json::array();
  for (const client::FlatChart& chart : flat.charts) charts.push_back(ChartJson(chart, flat));
  Json cuts = Json::array();
  for (std::size_t i = 0; i + 1 < flat.cut_edges.size(); i += 2) {
    cuts.push_back({flat.cut_edges[i], flat.cut_edges[i + 1]});
  }
  Json json{{"vertices", mesh.vertex_count()},
            {"triangles", mesh.triangle_count()},
            {"flat_positions", flat.uv.size() / 2},
            {"distortion", DistortionJson(flat.distortion)},
            {"boundary_overlaps", flat.boundary_overlaps},
            {"anchor_vertices", flat.anchor_vertices},
            {"charts", charts},
            {"cut_edges", cuts},
            {"auto_cut_count", flat.auto_cut_count},
            {"left_out_triangles", flat.left_out_triangles},
            {"warnings", warnings},
            {"surface_cached", flat.surface_cached},
            {"queue_micros", flat.queue_micros},
            {"solve_micros", flat.solve_micros}};
  if (sigma) {
    Json& values = json["singular_values"] = Json::array();
    for (std::size_t i = 0; i + 1 < flat.singular_values.size(); i += 2) {
      values.push_back({flat.singular_values[i], flat.singular_values[i + 1]});
    }
  }
  return json.dump(2) + "\n";
}

std::vector<std::string> Measures(const client::Distortion& d) {
  return {
      fmt::format("stretch mean {:.3f} %, max {:.3f} %; compression mean {:.3f} %, max {:.3f} %",
                  d.mean_stretch_percent, d.max_stretch_percent, d.mean_compression_percent,
                  d.max_compression_percent),
      fmt::format(
          "angles mean {:.3f}°, max {:.3f}°; ARAP energy {:.3g}; symmetric Dirichlet {:.6g}",
          d.mean_angle_degrees, d.max_angle_degrees, d.arap_energy, d.symmetric_dirichlet)};
}

std::vector<std::string> Summary(const client::SurfaceMesh& mesh, const client::FlatSurface& flat) {
  std::vector<std::string> lines{fmt::format(
      "{} vertices, {} triangles, {} flipped; area {:.4f} of the surface's", mesh.vertex_count(),
      mesh.triangle_count(), flat.distortion.flipped, flat.distortion.area_ratio)};
  for (std::string& line : Measures(flat.distortion)) lines.push_back(std::move(line));
  const std::size_t cuts = flat.cut_edges.size() / 2;
  if (flat.charts.size() > 1 || cuts > 0 || flat.boundary_overlaps) {
    lines.push_back(fmt::format("{} piece{}, {} edges cut, {} of them automatically{}",
                                flat.charts.size(), flat.charts.size() == 1 ? "" : "s", cuts,
                                flat.auto_cut_count,
                                flat.boundary_overlaps ? "; the outline overlaps itself" : ""));
  }
  return lines;
}

}  // namespace arap::cli
