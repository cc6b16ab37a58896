#include "client/src/convert.h"

namespace arap::client::internal {
namespace {

struct AnchorToWire {
  v1::Handle* out;

  void operator()(const VertexAnchor& anchor) const { out->set_vertex(anchor.vertex); }
  void operator()(const TriangleAnchor& anchor) const {
    out->mutable_triangle_point()->set_triangle(anchor.triangle);
    for (const double weight : anchor.barycentric) {
      out->mutable_triangle_point()->add_barycentric(weight);
    }
  }
  void operator()(const PointAnchor& anchor) const {
    out->mutable_position()->set_x(anchor.x);
    out->mutable_position()->set_y(anchor.y);
  }
};

HandleInfo FromWire(const v1::HandleInfo& handle) {
  return {handle.handle_id(), handle.rest().x(), handle.rest().y(), handle.snapped_distance(),
          handle.component()};
}

}  // namespace

void ToWire(const Handle& handle, v1::Handle* out) {
  out->set_handle_id(handle.id);
  std::visit(AnchorToWire{out}, handle.anchor);
  if (handle.weight) out->set_weight(*handle.weight);
  out->set_hard(handle.hard);
  out->set_oriented(handle.oriented);
  out->set_area_radius(handle.area_radius);
  out->set_outside(handle.snap ? v1::OUTSIDE_POLICY_SNAP : v1::OUTSIDE_POLICY_ERROR);
  out->set_depth(handle.depth);
  out->set_depth_falloff(handle.depth_falloff);
}

void ToWire(const HandleTarget& target, v1::HandleTarget* out) {
  out->set_handle_id(target.id);
  out->set_x(target.x);
  out->set_y(target.y);
  out->set_angle_radians(target.angle_radians);
  out->set_scale(target.scale);
}

HandleSetInfo FromWire(const v1::HandleSetInfo& set) {
  HandleSetInfo out;
  out.id = set.handle_set_id();
  out.mesh_id = set.mesh_id();
  for (const v1::HandleInfo& handle : set.handles()) out.handles.push_back(FromWire(handle));
  out.row_count = set.row_count();
  out.bytes = set.bytes();
  out.warnings = FromWire(set.warnings());
  out.depth = Values<double>(set.depth());
  out.draw_order = Values<std::uint32_t>(set.draw_order());
  out.revision = set.revision();
  out.resting_components = set.resting_components();
  out.translating_components = set.translating_components();
  return out;
}

}  // namespace arap::client::internal
