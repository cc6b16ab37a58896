// The flat surface, from the core to the wire.
#include <cmath>

#include <arap/v1/flattening_service.pb.h>

#include "server/rpc/convert_flatten.h"
#include "server/rpc/convert_mesh.h"
#include "server/rpc/convert_shape.h"

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
  out->set_worst_triangle(distortion.worst_triangle);
}

void SetChart(const FlatChart& chart, v1::FlatChart* out) {
  for (const auto& loop : chart.loops) {
    out->add_loops()->mutable_uv_indices()->Assign(loop.begin(), loop.end());
  }
  out->mutable_anchors()->Assign(chart.anchors.begin(), chart.anchors.end());
  out->set_triangle_count(chart.triangles);
  SetDistortion(chart.distortion, out->mutable_distortion());
  out->set_boundary_crossings(chart.crossings);
  out->set_refinements(static_cast<std::uint32_t>(chart.refinements));
}

template <std::size_t kCount>
void SetGroups(const std::vector<std::array<std::uint32_t, kCount>>& groups,
               google::protobuf::RepeatedField<std::uint32_t>* out) {
  out->Reserve(static_cast<int>(kCount * groups.size()));
  for (const auto& group : groups) out->Add(group.begin(), group.end());
}

Status SetSingularValues(const Flattening& flat, google::protobuf::RepeatedField<float>* out) {
  out->Reserve(static_cast<int>(2 * flat.singular_values.size()));
  for (const auto& pair : flat.singular_values) {
    for (const double value : pair) {
      const auto rounded = static_cast<float>(value);
      if (!std::isfinite(rounded)) {
        return Fail(FaultKind::kNumerical, "A singular value of the result is not a finite float.");
      }
      out->Add(rounded);
    }
  }
  return {};
}

}  // namespace

Status ToWire(const Flattening& flat, const v1::FlattenRequest& request,
              v1::FlattenResponse* response) {
  const auto packed = request.float64() ? ToDoubles(flat.uv, response->mutable_uv64())
                                        : ToFloats(flat.uv, response->mutable_uv());
  if (!packed) return packed;
  if (request.include_first_step()) {
    if (auto good = ToDoubles(flat.first_step, response->mutable_first_step_uv()); !good) {
      return good;
    }
  }
  if (request.include_singular_values()) {
    auto good = SetSingularValues(flat, response->mutable_singular_values());
    if (!good) return good;
  }
  response->mutable_uv_vertex()->Assign(flat.source.begin(), flat.source.end());
  SetGroups(flat.corner_uv, response->mutable_corner_uv());
  response->mutable_triangle_chart()->Assign(flat.triangle_chart.begin(),
                                             flat.triangle_chart.end());
  SetDistortion(flat.distortion, response->mutable_distortion());
  for (const FlatChart& chart : flat.charts) SetChart(chart, response->add_charts());
  if (!flat.charts.empty()) {
    for (const std::uint32_t anchor : flat.charts.front().anchors) {
      response->add_anchor_vertices(flat.source[anchor]);
    }
  }
  ToWire(flat.warnings, response->mutable_warnings());
  SetGroups(flat.cuts, response->mutable_cut_edges());
  response->set_auto_cut_count(static_cast<std::uint32_t>(flat.auto_cuts));
  response->mutable_left_out_triangles()->Assign(flat.degenerate.begin(), flat.degenerate.end());
  response->set_boundary_overlaps(flat.overlaps);
  return {};
}

}  // namespace arap::rpc
