#include "server/rpc/convert_handles.h"

#include <cmath>
#include <limits>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>

#include "arap/core/depth_order.h"
#include "core/base/names.h"
#include "server/rpc/convert_mesh.h"
#include "server/sessions/rebuild.h"

namespace arap::rpc {
namespace {

constexpr double kBarycentricTolerance = 1e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Status CheckRange(double value, double low, double high, const std::string& field) {
  if (std::isfinite(value) && value >= low && value <= high) return {};
  std::string message = fmt::format("{} is {}, but must be finite", field, value);
  if (low > -kInfinity) message += fmt::format(", at least {}", low);
  if (high < kInfinity) message += fmt::format(", at most {}", high);
  Fault fault = Fault(FaultKind::kInvalidOption, message + ".").Field(field);
  return Fail(fault.Detail("value", fmt::format("{}", value)));
}

Result<TriangleAnchor> FromWire(const v1::TrianglePoint& point, const std::string& path) {
  const std::string field = path + ".triangle_point.barycentric";
  if (point.barycentric_size() != 3) {
    Fault fault = Fault(FaultKind::kArrayLength,
                        fmt::format("{} has {} numbers, not 3.", field, point.barycentric_size()))
                      .Field(field);
    return Fail(
        fault.Detail("length", std::to_string(point.barycentric_size())).Detail("expected", "3"));
  }
  TriangleAnchor anchor{point.triangle(),
                        {point.barycentric(0), point.barycentric(1), point.barycentric(2)}};
  double sum = 0;
  for (const double weight : anchor.barycentric) {
    // Written so that NaN fails too.
    if (!(weight >= -kBarycentricTolerance && weight <= 1 + kBarycentricTolerance)) {
      Fault fault = Fault(FaultKind::kInvalidOption,
                          fmt::format("{} has the weight {}, not between 0 and 1.", field, weight))
                        .Field(field);
      return Fail(fault.Detail("value", fmt::format("{}", weight)));
    }
    sum += weight;
  }
  if (std::abs(sum - 1) > kBarycentricTolerance) {
    Fault fault = Fault(FaultKind::kInvalidOption, fmt::format("{} sums to {}, not to 1 within {}.",
                                                               field, sum, kBarycentricTolerance))
                      .Field(field);
    return Fail(fault.Detail("value", fmt::format("{}", sum)));
  }
  return anchor;
}

Status SetAnchor(const v1::Handle& handle, const std::string& path, Handle& out) {
  switch (handle.anchor_case()) {
    case v1::Handle::kVertex:
      out.anchor = VertexAnchor{handle.vertex()};
      return {};
    case v1::Handle::kTrianglePoint: {
      auto anchor = FromWire(handle.triangle_point(), path);
      if (!anchor) return Fail(std::move(anchor.error()));
      out.anchor = *anchor;
      return {};
    }
    case v1::Handle::kPosition:
      out.anchor = PointAnchor{{handle.position().x(), handle.position().y()}};
      if (auto x = CheckRange(handle.position().x(), -kInfinity, kInfinity, path + ".position.x");
          !x) {
        return x;
      }
      return CheckRange(handle.position().y(), -kInfinity, kInfinity, path + ".position.y");
    case v1::Handle::ANCHOR_NOT_SET:
      break;
  }
  return Fail(Fault(FaultKind::kInvalidOption,
                    path + " has no anchor: give vertex, triangle_point or position.")
                  .Field(path));
}

Status SetOutside(v1::OutsidePolicy policy, const std::string& path, Handle& out) {
  switch (policy) {
    case v1::OUTSIDE_POLICY_UNSPECIFIED:
    case v1::OUTSIDE_POLICY_ERROR:
      out.outside = Outside::kError;
      return {};
    case v1::OUTSIDE_POLICY_SNAP:
      out.outside = Outside::kSnap;
      return {};
    default:
      return Fail(
          Fault(FaultKind::kInvalidOption,
                fmt::format("{}.outside has the value {}, which this version does not know.", path,
                            static_cast<int>(policy)))
              .Field(path + ".outside")
              .Detail("value", std::to_string(policy)));
  }
}

Status FromWire(const v1::Handle& handle, const std::string& path, Handle& out) {
  out.id = handle.handle_id();
  out.weight = handle.has_weight() ? handle.weight() : Handle::kDefaultWeight;
  out.hard = handle.hard();
  out.oriented = handle.oriented();
  out.area_radius = handle.area_radius();
  out.depth = handle.depth();
  out.depth_falloff = handle.depth_falloff();
  return CheckName(out.id, path + ".handle_id")
      .and_then([&] { return SetAnchor(handle, path, out); })
      .and_then([&] { return SetOutside(handle.outside(), path, out); })
      .and_then([&] {
        return CheckRange(out.weight, Handle::kMinWeight, Handle::kMaxWeight, path + ".weight");
      })
      .and_then([&] { return CheckRange(out.area_radius, 0, kInfinity, path + ".area_radius"); })
      .and_then([&] {
        return CheckRange(out.depth, -Handle::kMaxDepth, Handle::kMaxDepth, path + ".depth");
      })
      .and_then(
          [&] { return CheckRange(out.depth_falloff, 0, kInfinity, path + ".depth_falloff"); });
}

Status CheckColumns(int length, std::size_t expected, const std::string& field, bool optional) {
  if (static_cast<std::size_t>(length) == expected || (optional && length == 0)) return {};
  Fault fault = Fault(FaultKind::kArrayLength,
                      fmt::format("{} has {} numbers, not {}.", field, length, expected))
                    .Field(field);
  return Fail(
      fault.Detail("length", std::to_string(length)).Detail("expected", std::to_string(expected)));
}

}  // namespace

Result<std::vector<Handle>> FromWire(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                                     std::string_view field) {
  std::vector<Handle> out(static_cast<std::size_t>(handles.size()));
  for (int i = 0; i < handles.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", field, i);
    if (auto good = FromWire(handles[i], path, out[static_cast<std::size_t>(i)]); !good) {
      return Fail(good.error().Element(static_cast<std::uint32_t>(i)));
    }
  }
  return out;
}

std::vector<app::NamedTarget> FromWire(
    const google::protobuf::RepeatedPtrField<v1::HandleTarget>& targets) {
  std::vector<app::NamedTarget> out;
  out.reserve(static_cast<std::size_t>(targets.size()));
  for (const v1::HandleTarget& target : targets) {
    out.push_back({target.handle_id(),
                   {{target.x(), target.y()},
                    target.angle_radians(),
                    target.has_scale() ? target.scale() : 1}});
  }
  return out;
}

Result<std::vector<Target>> FromWire(const v1::TrackFrame& frame, std::size_t index,
                                     const std::vector<std::size_t>& order) {
  const std::string path = fmt::format("frames[{}]", index);
  const auto lengths =
      CheckColumns(frame.positions_size(), 2 * order.size(), path + ".positions", false)
          .and_then([&] {
            return CheckColumns(frame.angles_radians_size(), order.size(), path + ".angles_radians",
                                true);
          })
          .and_then([&] {
            return CheckColumns(frame.scales_size(), order.size(), path + ".scales", true);
          });
  if (!lengths) return Fail(lengths.error());

  std::vector<Target> targets(order.size());
  for (int i = 0; i < static_cast<int>(order.size()); ++i) {
    Target& target = targets[order[static_cast<std::size_t>(i)]];
    target.position = {frame.positions(2 * i), frame.positions(2 * i + 1)};
    if (frame.angles_radians_size() > 0) target.angle = frame.angles_radians(i);
    if (frame.scales_size() > 0) target.scale = frame.scales(i);
    if (auto good = app::CheckTarget(target, fmt::format("{}.targets[{}]", path, i)); !good) {
      return Fail(good.error().Detail("frame", std::to_string(index)).Field(path));
    }
  }
  return targets;
}

void ToWire(const app::HandleSetEntry& entry, v1::HandleSetInfo* out) {
  const CompiledHandles& handles = *entry.handles;
  out->set_handle_set_id(entry.handle_set_id);
  out->set_mesh_id(entry.mesh_id);
  for (const PlacedHandle& placed : handles.handles()) {
    v1::HandleInfo& info = *out->add_handles();
    info.set_handle_id(placed.handle.id);
    info.mutable_rest()->set_x(placed.rest.real());
    info.mutable_rest()->set_y(placed.rest.imag());
    info.set_snapped_distance(placed.snapped_distance);
    info.set_component(placed.component);
  }
  out->set_row_count(handles.rows());
  out->set_bytes(handles.bytes());
  ToWire(handles.warnings(), out->mutable_warnings());
  for (const double depth : VertexDepths(handles)) out->add_depth(static_cast<float>(depth));
  const std::vector<std::uint32_t> draw_order = DrawOrder(handles);
  out->mutable_draw_order()->Assign(draw_order.begin(), draw_order.end());
  out->set_revision(entry.revision);
  out->set_resting_components(handles.resting_components());
  out->set_translating_components(handles.translating_components());
}

}  // namespace arap::rpc
