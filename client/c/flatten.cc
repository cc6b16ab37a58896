// Flattening for C, and what its jobs share with it.
#include <utility>

#include "client/c/objects.h"

using arap::Status;
using arap::c::Need;
namespace client = arap::client;

namespace arap::c {
namespace {

Result<client::FlattenOptions> MethodOf(std::int32_t method) {
  switch (method) {
    case ARAP_FLATTEN_DEFAULT:
    case ARAP_FLATTEN_ARAP:
      return client::ArapOptions();
    case ARAP_FLATTEN_FIRST_STEP:
      return client::FirstStepOptions();
    case ARAP_FLATTEN_LSCM:
      return client::LscmOptions();
    case ARAP_FLATTEN_ABF:
      return client::AbfOptions();
    default:
      return Fail(BadChoice("method", "is no method", method));
  }
}

Status FillCuts(const arap_flatten_options& given, client::FlattenOptions& options) {
  TRY(const auto seams, ArrayOf(given.seams, given.seam_count, "seams"));
  for (std::size_t i = 0; i < seams.size(); ++i) {
    options.cut.seams.push_back({given.seams[2 * i], given.seams[2 * i + 1]});
  }
  options.cut.auto_cut = given.auto_cut != 0;
  options.cut.split_non_manifold = given.split_non_manifold != 0;
  options.cut.tolerate_degenerate = given.tolerate_degenerate != 0;
  options.cut.repair = RepairsOf(given.repairs);
  return {};
}

Result<client::FlattenQuery> QueryOf(const arap_flatten_options& given, std::size_t triangles) {
  client::FlattenQuery query;
  client::FlattenOptions& options = query.options;
  TRY(options, MethodOf(given.method));
  TRY(options.energy.basis, BasisOf(given.basis, options.energy.basis));
  options.energy.rigidity = NumbersOf(given.rigidity, triangles);
  if (given.refine != 0) options.refine = std::max(given.refine, 0);
  options.injective = given.injective != 0;
  CHECK_OK(FillCuts(given, options));
  TRY(const auto pins, ArrayOf(given.pins, given.pin_count, "pins"));
  for (const arap_pin& pin : pins) {
    options.pins.push_back({pin.vertex, {pin.u, pin.v}, pin.weight});
  }
  TRY(const auto grains, ArrayOf(given.grains, given.grain_count, "grains"));
  for (const arap_grain& grain : grains) {
    options.grain_lines.push_back({grain.from, grain.to, grain.angle});
  }
  query.float64 = given.float64 != 0;
  CHECK_OK(FillDrawings(given, query));
  return query;
}

Result<client::SurfaceMesh> SurfaceOf(const double* vertices, std::size_t vertex_count,
                                      const std::uint32_t* triangles, std::size_t triangle_count) {
  CHECK_OK(ArrayOf(vertices, vertex_count, "vertices"));
  client::SurfaceMesh mesh;
  mesh.vertices.resize(vertex_count);
  for (std::size_t i = 0; i < vertex_count; ++i) {
    mesh.vertices[i] = {vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]};
  }
  TRY(mesh.triangles, TrianglesOf(triangles, triangle_count));
  return mesh;
}

}  // namespace

Result<FlattenWork> WorkOf(const double* vertices, std::size_t vertex_count,
                           const std::uint32_t* triangles, std::size_t triangle_count,
                           const arap_flatten_options* options) {
  FlattenWork work;
  TRY(work.mesh, SurfaceOf(vertices, vertex_count, triangles, triangle_count));
  TRY(const auto given, OptionsOf(options, "options"));
  TRY(work.query, QueryOf(given, triangle_count));
  return work;
}

arap_flat* FlatOf(client::FlatSurface&& flat) {
  auto answer = std::make_unique<arap_flat>();
  answer->flat = std::move(flat.flat);
  answer->warnings.all = std::move(answer->flat.warnings);
  for (client::Drawing& drawing : flat.drawings) {
    answer->drawings.push_back({std::move(drawing.files), {std::move(drawing.warnings)}});
  }
  return answer.release();
}

}  // namespace arap::c

extern "C" {

arap_error* arap_flatten(const arap_client* client, const double* vertices, size_t vertex_count,
                         const uint32_t* triangles, size_t triangle_count,
                         const arap_flatten_options* options, const arap_call_options* call,
                         arap_flat** out) {
  return arap::c::Guard([&]() -> Status {
    CHECK_OK(Need(client, "client"));
    CHECK_OK(Need(out, "out"));
    TRY(const auto work,
        arap::c::WorkOf(vertices, vertex_count, triangles, triangle_count, options));
    TRY(const auto calling, arap::c::CallOf(call));
    TRY(auto flat, client->client.Flatten(work.mesh, work.query, calling));
    *out = arap::c::FlatOf(std::move(flat));
    return {};
  });
}

size_t arap_flat_count(const arap_flat* flat) { return flat->flat.uv.size(); }
const double* arap_flat_uv(const arap_flat* flat) { return arap::c::Doubles(flat->flat.uv); }
const uint32_t* arap_flat_source(const arap_flat* flat) { return flat->flat.source.data(); }
const uint32_t* arap_flat_corners(const arap_flat* flat) {
  return reinterpret_cast<const uint32_t*>(flat->flat.corner_uv.data());
}
const uint32_t* arap_flat_charts(const arap_flat* flat) { return flat->flat.triangle_chart.data(); }

size_t arap_flat_chart_count(const arap_flat* flat) { return flat->flat.charts.size(); }
size_t arap_flat_loop_count(const arap_flat* flat, size_t chart) {
  const auto& charts = flat->flat.charts;
  return chart < charts.size() ? charts[chart].loops.size() : 0;
}
size_t arap_flat_loop_length(const arap_flat* flat, size_t chart, size_t loop) {
  return loop < arap_flat_loop_count(flat, chart) ? flat->flat.charts[chart].loops[loop].size() : 0;
}
const uint32_t* arap_flat_loop(const arap_flat* flat, size_t chart, size_t loop) {
  if (loop >= arap_flat_loop_count(flat, chart)) return nullptr;
  return flat->flat.charts[chart].loops[loop].data();
}

arap_distortion arap_flat_distortion(const arap_flat* flat) {
  const client::Distortion& measured = flat->flat.distortion;
  return {measured.arap_energy,
          measured.symmetric_dirichlet,
          measured.area_ratio,
          measured.mean_stretch_percent,
          measured.max_stretch_percent,
          measured.mean_compression_percent,
          measured.max_compression_percent,
          measured.mean_angle_degrees,
          measured.max_angle_degrees,
          measured.flipped,
          measured.worst_triangle};
}
int32_t arap_flat_overlaps(const arap_flat* flat) { return flat->flat.overlaps ? 1 : 0; }
const arap_warnings* arap_flat_warnings(const arap_flat* flat) { return &flat->warnings; }
void arap_flat_free(arap_flat* flat) { delete flat; }

}  // extern "C"
