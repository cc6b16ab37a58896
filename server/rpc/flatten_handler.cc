#include <cmath>
#include <numeric>

#include <arap/v1/flattening_service.pb.h>
#include <fmt/format.h>

#include "core/flatten/flattener.h"
#include "server/app/engine.h"
#include "server/rpc/convert_mesh.h"
#include "server/rpc/convert_session.h"
#include "server/rpc/convert_shape.h"
#include "server/rpc/handlers.h"
#include "server/runtime/stopwatch.h"

namespace arap::rpc {
namespace {

void SetDistortion(const Distortion& distortion, v1::Distortion* out) {
  out->set_arap_energy(distortion.arap_energy);
  out->set_symmetric_dirichlet(distortion.symmetric_dirichlet);
  out->set_area_ratio(distortion.area_ratio);
  out->set_mean_stretch_percent(distortion.mean_stretch_percent);
  out->set_max_stretch_percent(distortion.max_stretch_percent);
  out->set_mean_compression_percent(distortion.mean_compression_percent);
  out->set_max_compression_percent(distortion.max_compression_percent);
  out->set_mean_angle_degrees(distortion.mean_angle_degrees);
  out->set_max_angle_degrees(distortion.max_angle_degrees);
  out->set_flipped(distortion.flipped);
  out->set_scale(1);
}

Status SingularValues(const Flattening& flat, google::protobuf::RepeatedField<float>* out) {
  out->Reserve(static_cast<int>(2 * flat.singular_values.size()));
  for (const auto& [s1, s2] : flat.singular_values) {
    out->Add(static_cast<float>(s1));
    out->Add(static_cast<float>(s2));
    if (std::isfinite(out->Get(out->size() - 2)) && std::isfinite(out->Get(out->size() - 1))) {
      continue;
    }
    return Fail(FaultKind::kNumerical, "A singular value of the result is not a finite float.");
  }
  return {};
}

Result<FlattenOptions> Options(const app::Limits& limits, const v1::FlattenRequest& request,
                               std::size_t triangles) {
  if (request.seam_edges_size() > 0) {
    return Fail(Fault{FaultKind::kUnimplemented,
                      "Cutting along seams is not served by this version.",
                      {},
                      {},
                      "seam_edges"});
  }
  if (request.refine() > limits.max_refine) {
    Fault fault{FaultKind::kInvalidOption,
                fmt::format("refine of {} is more than max_refine of {}.", request.refine(),
                            limits.max_refine),
                {},
                {},
                "refine"};
    return Fail(fault.Detail("value", std::to_string(request.refine()))
                    .Detail("quota", "max_refine")
                    .Detail("limit", std::to_string(limits.max_refine)));
  }
  auto energy = FromWire(request.energy(), Weights::kCotangent, triangles);
  if (!energy) return Fail(std::move(energy.error()));
  FlattenOptions options;
  options.energy = *std::move(energy);
  options.refine = static_cast<int>(request.refine());
  options.limits = {limits.max_vertices, limits.max_triangles};
  return options;
}

Status Answer(const v1::FlattenRequest& request, const Flattening& flat,
              v1::FlattenResponse* response) {
  const auto packed = request.float64() ? ToDoubles(flat.uv, response->mutable_uv64())
                                        : ToFloats(flat.uv, response->mutable_uv());
  if (!packed) return packed;
  response->mutable_uv_vertex()->Resize(static_cast<int>(flat.uv.size()), 0);
  std::iota(response->mutable_uv_vertex()->begin(), response->mutable_uv_vertex()->end(), 0u);
  // Without seams every corner keeps its vertex, in the order of the request.
  *response->mutable_corner_uv() = request.mesh().triangles();
  if (request.include_first_step()) {
    if (auto good = ToDoubles(flat.first_step, response->mutable_first_step_uv()); !good) {
      return good;
    }
  }
  if (request.include_singular_values()) {
    if (auto good = SingularValues(flat, response->mutable_singular_values()); !good) return good;
  }
  SetDistortion(flat.distortion, response->mutable_distortion());
  ToWire(flat.warnings, response->mutable_warnings());
  response->mutable_anchor_vertices()->Assign(flat.anchors.begin(), flat.anchors.end());
  return {};
}

}  // namespace

Status Flatten(app::Engine& engine, const v1::FlattenRequest& request, const Call& call,
               v1::FlattenResponse* response) {
  const runtime::Stopwatch working;
  auto mesh = FromWire(request.mesh(), {engine.limits.max_vertices, engine.limits.max_triangles});
  if (!mesh) return Fail(std::move(mesh.error()));
  auto options = Options(engine.limits, request, mesh->triangles.size());
  if (!options) return Fail(std::move(options.error()));
  auto flat = arap::Flatten(*std::move(mesh), *options, call.cancel);
  if (!flat) return Fail(std::move(flat.error()));
  if (auto good = Answer(request, *flat, response); !good) return good;
  SetMicros(call.queue_micros, response->mutable_queue_time());
  SetMicros(working.Micros(), response->mutable_solve_time());
  return {};
}

}  // namespace arap::rpc
