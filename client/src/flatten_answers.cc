// Surfaces laid flat, and the drawings that were asked for with them.
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

#include "arap/v1/flattening_service.pb.h"
#include "client/src/answer_checks.h"
#include "core/base/try.h"
#include "proto/convert/flatten.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"

namespace arap::client::internal {
namespace {

// A count that is an int in the model.
constexpr auto kLargestInt = static_cast<std::uint32_t>(std::numeric_limits<int>::max());

Status CheckDistortion(const Distortion& d, std::size_t triangles) {
  CHECK_OK(CheckNumbers({d.arap_energy, d.symmetric_dirichlet, d.area_ratio, d.mean_stretch_percent,
                         d.max_stretch_percent, d.mean_compression_percent,
                         d.max_compression_percent, d.mean_angle_degrees, d.max_angle_degrees},
                        "a distortion"));
  return CheckIndices(std::array{d.worst_triangle}, std::max<std::size_t>(triangles, 1),
                      "triangle");
}

Status CheckChart(const FlatChart& chart, std::size_t positions, std::size_t triangles) {
  for (const auto& loop : chart.loops) {
    CHECK_OK(CheckIndices(loop, positions, "the flat position"));
  }
  CHECK_OK(CheckIndices(chart.anchors, positions, "the flat position"));
  if (chart.triangles > triangles) {
    return Bad("The server answered a chart of {} triangles; the mesh has {}.", chart.triangles,
               triangles);
  }
  return CheckDistortion(chart.distortion, triangles);
}

// Each corner of the layout is a copy of its vertex in the mesh, or of the one that stands for it.
Status CheckCorners(const Flattening& flat, const SurfaceMesh& mesh) {
  for (std::size_t t = 0; t < flat.corner_uv.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = flat.corner_uv[t][k];
      const std::uint32_t v = mesh.triangles[t][k];
      const std::uint32_t wanted = v < flat.welded.size() ? flat.welded[v] : v;
      if (corner < flat.source.size() && flat.source[corner] == wanted) continue;
      return Bad(
          "The server answered a layout in which corner {} of triangle {} is not its vertex.", k,
          t);
    }
  }
  return {};
}

Status CheckLayout(const Flattening& flat, const SurfaceMesh& mesh, const FlattenQuery& query) {
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  if (flat.uv.size() < vertices) {
    return Bad("The server answered {} flat positions for {} vertices.", flat.uv.size(), vertices);
  }
  const std::size_t positions = flat.uv.size();
  CHECK_OK(CheckCount(flat.source.size(), positions, "vertices of flat positions"));
  CHECK_OK(CheckIndices(flat.source, vertices, "vertex"));
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (flat.source[v] != v)
      return Bad("The server answered flat position {} out of its place.", v);
  }
  const bool welded = query.options.cut.repair.weld && !flat.welded.empty();
  CHECK_OK(CheckCount(flat.welded.size(), welded ? vertices : 0, "welded vertices"));
  CHECK_OK(CheckIndices(flat.welded, vertices, "vertex"));
  CHECK_OK(CheckCount(flat.corner_uv.size(), triangles, "flat triangles"));
  CHECK_OK(CheckCorners(flat, mesh));
  CHECK_OK(CheckFinite(flat.uv, "the flat position"));
  CHECK_OK(CheckCount(flat.first_step.size(), query.first_step ? positions : 0,
                      "positions after the first step"));
  CHECK_OK(CheckFinite(flat.first_step, "the first step's position"));
  CHECK_OK(CheckCount(flat.singular_values.size(), query.singular_values ? triangles : 0,
                      "pairs of singular values"));
  for (const auto& [s1, s2] : flat.singular_values) {
    CHECK_OK(CheckNumbers({s1, s2}, "the singular values"));
  }
  CHECK_OK(CheckCount(flat.triangle_chart.size(), triangles, "triangles with a chart"));
  CHECK_OK(CheckIndices(flat.triangle_chart, flat.charts.size(), "chart"));
  for (const FlatChart& chart : flat.charts) CHECK_OK(CheckChart(chart, positions, triangles));
  for (const auto& cut : flat.cuts) CHECK_OK(CheckIndices(cut, vertices, "vertex"));
  if (flat.auto_cuts > flat.cuts.size()) {
    return Bad("The server answered {} automatic cuts of {}.", flat.auto_cuts, flat.cuts.size());
  }
  CHECK_OK(CheckIndices(flat.degenerate, triangles, "triangle"));
  return CheckDistortion(flat.distortion, triangles);
}

bool IsPage(std::string_view page) {
  constexpr std::size_t kLongest = 9;
  return page == "cover" ||
         (!page.empty() && page.size() <= kLongest &&
          std::all_of(page.begin(), page.end(), [](char c) { return c >= '0' && c <= '9'; }));
}

// Those that were asked for, each as one file or as the pages of an SVG, whose names are fit for names
// of files.
Result<std::vector<Drawing>> DrawingsOf(const v1::FlattenResponse& response,
                                        const FlattenQuery& query) {
  std::vector<Drawing> drawings = convert::DrawingsFromWire(response);
  if (drawings.size() != query.drawings.size()) {
    return Bad("The server answered {} drawings, not {}.", drawings.size(), query.drawings.size());
  }
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    const DrawingOptions& options = query.drawings[i];
    const std::vector<DrawingFile>& files = drawings[i].files;
    const bool pages = options.format == DrawingFormat::kSvg && !options.paper.empty();
    const bool named = std::all_of(files.begin(), files.end(), [&](const DrawingFile& file) {
      return (pages ? IsPage(file.page) : file.page.empty()) && !file.bytes.empty();
    });
    if (named && (pages ? !files.empty() : files.size() == 1)) continue;
    return Bad("The server answered drawing {} without its files.", i);
  }
  return drawings;
}

}  // namespace

void ToWire(const SurfaceMesh& mesh, const FlattenQuery& query, v1::FlattenRequest* out) {
  convert::ToWire(mesh, out->mutable_mesh());
  convert::ToWire(query.options, out);
  out->set_surface_key(query.surface_key);
  out->set_include_first_step(query.first_step);
  out->set_include_singular_values(query.singular_values);
  out->set_float64(query.float64);
  convert::ToWire(query.drawings, query.parts, out);
}

Result<FlatSurface> FromWire(const v1::FlattenResponse& response, const SurfaceMesh& mesh,
                             const FlattenQuery& query) {
  const bool other = query.float64 ? response.uv_size() > 0 : response.uv64_size() > 0;
  if (other) return Bad("The server answered a layout in another precision than was asked.");
  for (const v1::FlatChart& chart : response.charts()) {
    if (chart.refinements() > kLargestInt) {
      return Bad("The server answered a chart of {} refinements.", chart.refinements());
    }
  }
  TRY(Flattening flat, convert::FromWire(response));
  CHECK_OK(CheckLayout(flat, mesh, query));
  TRY(std::vector<Drawing> drawings, DrawingsOf(response, query));
  return FlatSurface{std::move(flat), std::move(drawings), response.surface_cached(),
                     convert::Micros(response.queue_time()),
                     convert::Micros(response.solve_time())};
}

}  // namespace arap::client::internal
