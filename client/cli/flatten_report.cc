#include "client/cli/flatten_report.h"

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
          {"scale", d.scale}};
}

}  // namespace

std::string JsonReport(const client::SurfaceMesh& mesh, const client::FlatSurface& flat) {
  Json warnings = Json::array();
  for (const client::Warning& warning : flat.warnings) {
    warnings.push_back({{"kind", warning.kind},
                        {"count", warning.count},
                        {"elements", warning.elements},
                        {"message", warning.message}});
  }
  const Json json{
      {"vertices", mesh.vertex_count()},         {"triangles", mesh.triangle_count()},
      {"flat_positions", flat.uv.size() / 2},    {"distortion", DistortionJson(flat.distortion)},
      {"anchor_vertices", flat.anchor_vertices}, {"warnings", warnings},
      {"queue_micros", flat.queue_micros},       {"solve_micros", flat.solve_micros}};
  return json.dump(2) + "\n";
}

std::vector<std::string> Summary(const client::SurfaceMesh& mesh, const client::FlatSurface& flat) {
  const client::Distortion& d = flat.distortion;
  return {
      fmt::format("{} vertices, {} triangles, {} flipped; area {:.4f} of the surface's",
                  mesh.vertex_count(), mesh.triangle_count(), d.flipped, d.area_ratio),
      fmt::format("stretch mean {:.3f} %, max {:.3f} %; compression mean {:.3f} %, max {:.3f} %",
                  d.mean_stretch_percent, d.max_stretch_percent, d.mean_compression_percent,
                  d.max_compression_percent),
      fmt::format(
          "angles mean {:.3f}°, max {:.3f}°; ARAP energy {:.3g}; symmetric Dirichlet {:.6g}",
          d.mean_angle_degrees, d.max_angle_degrees, d.arap_energy, d.symmetric_dirichlet),
  };
}

}  // namespace arap::cli
