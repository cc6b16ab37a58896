#include "client/src/convert.h"

namespace arap::client::internal {
namespace {

v1::FlattenMethod ToWire(FlattenMethod method) {
  switch (method) {
    case FlattenMethod::kDefault:
      return v1::FLATTEN_METHOD_UNSPECIFIED;
    case FlattenMethod::kArapEdge:
      return v1::FLATTEN_METHOD_ARAP_EDGE;
    case FlattenMethod::kArapFace:
      return v1::FLATTEN_METHOD_ARAP_FACE;
    case FlattenMethod::kLscm:
      return v1::FLATTEN_METHOD_LSCM;
    case FlattenMethod::kFirstStep:
      return v1::FLATTEN_METHOD_FIRST_STEP;
    case FlattenMethod::kAbf:
      return v1::FLATTEN_METHOD_ABF;
  }
  return v1::FLATTEN_METHOD_UNSPECIFIED;
}

v1::FlattenAnchors ToWire(FlattenAnchors anchors) {
  switch (anchors) {
    case FlattenAnchors::kDefault:
      return v1::FLATTEN_ANCHORS_UNSPECIFIED;
    case FlattenAnchors::kCenterEdge:
      return v1::FLATTEN_ANCHORS_CENTER_EDGE;
    case FlattenAnchors::kFarBoundary:
      return v1::FLATTEN_ANCHORS_FAR_BOUNDARY;
    case FlattenAnchors::kSpectral:
      return v1::FLATTEN_ANCHORS_SPECTRAL;
  }
  return v1::FLATTEN_ANCHORS_UNSPECIFIED;
}

void ToWire(const UvPin& pin, v1::UvPin* out) {
  out->set_vertex(pin.vertex);
  out->set_u(pin.u);
  out->set_v(pin.v);
  out->set_weight(pin.weight);
}

void ToWire(const GrainLine& line, v1::GrainLine* out) {
  out->set_from_vertex(line.from_vertex);
  out->set_to_vertex(line.to_vertex);
  out->set_angle_degrees(line.angle_degrees);
}

Distortion FromWire(const v1::Distortion& distortion) {
  Distortion out;
  out.arap_energy = distortion.arap_energy();
  out.symmetric_dirichlet = distortion.symmetric_dirichlet();
  out.area_ratio = distortion.area_ratio();
  out.mean_stretch_percent = distortion.mean_stretch_percent();
  out.max_stretch_percent = distortion.max_stretch_percent();
  out.mean_compression_percent = distortion.mean_compression_percent();
  out.max_compression_percent = distortion.max_compression_percent();
  out.mean_angle_degrees = distortion.mean_angle_degrees();
  out.max_angle_degrees = distortion.max_angle_degrees();
  out.flipped = distortion.flipped();
  out.scale = distortion.scale();
  out.worst_triangle = distortion.worst_triangle();
  return out;
}

FlatChart FromWire(const v1::FlatChart& chart) {
  FlatChart out;
  for (const v1::FlatLoop& loop : chart.loops()) {
    out.loops.push_back(Values<std::uint32_t>(loop.uv_indices()));
  }
  out.anchors = Values<std::uint32_t>(chart.anchors());
  out.triangle_count = chart.triangle_count();
  out.distortion = FromWire(chart.distortion());
  out.boundary_crossings = chart.boundary_crossings();
  out.refinements = chart.refinements();
  return out;
}

}  // namespace

void ToWire(const FlattenOptions& options, v1::FlattenRequest* out) {
  out->set_method(ToWire(options.method));
  ToWire(options.energy, out->mutable_energy());
  out->set_anchors(ToWire(options.anchors));
  if (options.refine) out->set_refine(*options.refine);
  if (options.refine_stop) out->set_refine_stop(*options.refine_stop);
  out->set_injective(options.injective);
  out->set_auto_cut(options.auto_cut);
  out->set_split_non_manifold(options.split_non_manifold);
  out->set_tolerate_degenerate(options.tolerate_degenerate);
  Append(std::span(options.seam_edges), out->mutable_seam_edges());
  for (const UvPin& pin : options.pins) ToWire(pin, out->add_pins());
  for (const GrainLine& line : options.grain_lines) ToWire(line, out->add_grain_lines());
  out->set_surface_key(options.surface_key);
  out->set_include_first_step(options.first_step);
  out->set_include_singular_values(options.singular_values);
  out->set_float64(options.float64);
}

FlatSurface FromWire(const v1::FlattenResponse& response) {
  FlatSurface out;
  out.uv =
      response.uv64_size() > 0 ? Values<double>(response.uv64()) : Values<double>(response.uv());
  out.uv_vertex = Values<std::uint32_t>(response.uv_vertex());
  out.corner_uv = Values<std::uint32_t>(response.corner_uv());
  out.first_step_uv = Values<double>(response.first_step_uv());
  out.singular_values = Values<double>(response.singular_values());
  out.distortion = FromWire(response.distortion());
  out.warnings = FromWire(response.warnings());
  out.anchor_vertices = Values<std::uint32_t>(response.anchor_vertices());
  for (const v1::FlatChart& chart : response.charts()) out.charts.push_back(FromWire(chart));
  out.triangle_chart = Values<std::uint32_t>(response.triangle_chart());
  out.cut_edges = Values<std::uint32_t>(response.cut_edges());
  out.auto_cut_count = response.auto_cut_count();
  out.left_out_triangles = Values<std::uint32_t>(response.left_out_triangles());
  out.boundary_overlaps = response.boundary_overlaps();
  out.surface_cached = response.surface_cached();
  out.queue_micros = Micros(response.queue_time());
  out.solve_micros = Micros(response.solve_time());
  return out;
}

}  // namespace arap::client::internal
