#include "proto/convert/deform.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <variant>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>

#include "core/base/plane.h"
#include "core/base/try.h"
#include "proto/convert/plain.h"

namespace arap::convert {
namespace {

Complex FromWire(const v1::Point& point) { return {point.x(), point.y()}; }

void ToWire(Complex point, v1::Point* out) {
  out->set_x(point.real());
  out->set_y(point.imag());
}

Status CheckLength(int length, std::size_t expected, const std::string& field) {
  if (static_cast<std::size_t>(length) == expected) return {};
  return Fail(Fault(FaultKind::kArrayLength,
                    fmt::format("{} has {} numbers, not {}.", field, length, expected))
                  .Field(field)
                  .Detail("length", length)
                  .Detail("expected", expected));
}

Result<TriangleAnchor> FromWire(const v1::TrianglePoint& point, const std::string& path) {
  CHECK_OK(CheckLength(point.barycentric_size(), 3, path + ".triangle_point.barycentric"));
  return TriangleAnchor{point.triangle(),
                        {point.barycentric(0), point.barycentric(1), point.barycentric(2)}};
}

using Anchor = decltype(Handle::anchor);

Result<Anchor> AnchorOf(const v1::Handle& handle, const std::string& path) {
  switch (handle.anchor_case()) {
    case v1::Handle::kVertex:
      return VertexAnchor{handle.vertex()};
    case v1::Handle::kTrianglePoint: {
      TRY(const TriangleAnchor anchor, FromWire(handle.triangle_point(), path));
      return anchor;
    }
    case v1::Handle::kPosition:
      return PointAnchor{FromWire(handle.position())};
    case v1::Handle::ANCHOR_NOT_SET:
      break;
  }
  return Fail(Fault(FaultKind::kInvalidOption,
                    path + " has no anchor: give vertex, triangle_point or position.")
                  .Field(path));
}

struct AnchorToWire {
  v1::Handle* out;

  void operator()(const VertexAnchor& anchor) const { out->set_vertex(anchor.vertex); }
  void operator()(const TriangleAnchor& anchor) const {
    out->mutable_triangle_point()->set_triangle(anchor.triangle);
    Append(anchor.barycentric, out->mutable_triangle_point()->mutable_barycentric());
  }
  void operator()(const PointAnchor& anchor) const {
    ToWire(anchor.position, out->mutable_position());
  }
};

constexpr EnumRow<v1::OutsidePolicy, Outside> kOutside[] = {
    {v1::OUTSIDE_POLICY_ERROR, Outside::kError},
    {v1::OUTSIDE_POLICY_SNAP, Outside::kSnap},
};
static_assert(std::size(kOutside) == v1::OutsidePolicy_ARRAYSIZE - 1);

constexpr EnumRow<v1::DeformMode, DeformMode> kModes[] = {
    {v1::DEFORM_MODE_RIGID, DeformMode::kRigid},
    {v1::DEFORM_MODE_SIMILARITY, DeformMode::kSimilarity},
    {v1::DEFORM_MODE_BASELINE, DeformMode::kBaseline},
};
static_assert(std::size(kModes) == v1::DeformMode_ARRAYSIZE - 1);

}  // namespace

Result<Handle> FromWire(const v1::Handle& handle, const std::string& path) {
  Handle out;
  out.id = handle.handle_id();
  TRY(out.anchor, AnchorOf(handle, path));
  if (handle.has_weight()) out.weight = handle.weight();
  out.hard = handle.hard();
  out.oriented = handle.oriented();
  out.area_radius = handle.area_radius();
  TRY(out.outside, ModelOf(kOutside, handle.outside(), Outside::kError, path + ".outside"));
  out.depth = handle.depth();
  out.depth_falloff = handle.depth_falloff();
  return out;
}

void ToWire(const Handle& handle, v1::Handle* out) {
  out->set_handle_id(handle.id);
  std::visit(AnchorToWire{out}, handle.anchor);
  out->set_weight(handle.weight);
  out->set_hard(handle.hard);
  out->set_oriented(handle.oriented);
  out->set_area_radius(handle.area_radius);
  out->set_outside(WireOf(kOutside, handle.outside));
  out->set_depth(handle.depth);
  out->set_depth_falloff(handle.depth_falloff);
}

PlacedHandle FromWire(const v1::HandleInfo& info) {
  PlacedHandle placed;
  placed.handle.id = info.handle_id();
  placed.rest = FromWire(info.rest());
  placed.snapped_distance = info.snapped_distance();
  placed.component = info.component();
  return placed;
}

void ToWire(const PlacedHandle& placed, v1::HandleInfo* out) {
  out->set_handle_id(placed.handle.id);
  ToWire(placed.rest, out->mutable_rest());
  out->set_snapped_distance(placed.snapped_distance);
  out->set_component(placed.component);
}

Target TargetFromWire(const v1::HandleTarget& target) {
  return {
      {target.x(), target.y()}, target.angle_radians(), target.has_scale() ? target.scale() : 1};
}

void ToWire(const HandleTarget& target, v1::HandleTarget* out) {
  out->set_handle_id(target.handle_id);
  out->set_x(target.target.position.real());
  out->set_y(target.target.position.imag());
  out->set_angle_radians(target.target.angle);
  out->set_scale(target.target.scale);
}

Result<std::vector<Target>> FromWire(const v1::TrackFrame& frame, std::size_t columns,
                                     const std::string& path) {
  CHECK_OK(CheckLength(frame.positions_size(), 2 * columns, path + ".positions"));
  const bool angles = frame.angles_radians_size() > 0;
  if (angles) {
    CHECK_OK(CheckLength(frame.angles_radians_size(), columns, path + ".angles_radians"));
  }
  const bool scales = frame.scales_size() > 0;
  if (scales) CHECK_OK(CheckLength(frame.scales_size(), columns, path + ".scales"));
  std::vector<Target> targets(columns);
  for (int i = 0; i < static_cast<int>(columns); ++i) {
    Target& target = targets[static_cast<std::size_t>(i)];
    target.position = {frame.positions(2 * i), frame.positions(2 * i + 1)};
    if (angles) target.angle = frame.angles_radians(i);
    if (scales) target.scale = frame.scales(i);
  }
  return targets;
}

void ToWire(std::span<const Target> targets, v1::TrackFrame* out) {
  const bool angles = std::any_of(targets.begin(), targets.end(),
                                  [](const Target& target) { return target.angle != 0; });
  const bool scales = std::any_of(targets.begin(), targets.end(),
                                  [](const Target& target) { return target.scale != 1; });
  for (const Target& target : targets) {
    out->add_positions(target.position.real());
    out->add_positions(target.position.imag());
    if (angles) out->add_angles_radians(target.angle);
    if (scales) out->add_scales(target.scale);
  }
}

Result<DeformOptions> FromWire(const v1::DeformOptions& options, std::uint32_t max_refine) {
  DeformOptions out;
  TRY(out.mode, ModelOf(kModes, options.mode(), DeformMode::kRigid, "options.mode"));
  if (options.refine() > max_refine) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("options.refine of {} is more than max_refine of {}.",
                                  options.refine(), max_refine))
                    .Field("options.refine")
                    .Detail("value", options.refine())
                    .Detail("quota", "max_refine")
                    .Detail("limit", max_refine));
  }
  out.refine = static_cast<int>(options.refine());
  if (options.has_measure_every()) out.measure_every = options.measure_every();
  return out;
}

void ToWire(const DeformOptions& options, v1::DeformOptions* out) {
  out->set_mode(WireOf(kModes, options.mode));
  out->set_refine(static_cast<std::uint32_t>(options.refine));
  if (options.measure_every != 1) out->set_measure_every(options.measure_every);
}

Result<std::vector<Complex>> PicksFromWire(const google::protobuf::RepeatedField<double>& numbers) {
  const auto count = static_cast<std::size_t>(numbers.size());
  if (count % 2 != 0 || count > 2 * kMaxPicks) {
    return Fail(
        Fault(FaultKind::kArrayLength,
              fmt::format("pick_points has {} numbers; it needs x y pairs, at most {} of them.",
                          count, kMaxPicks))
            .Field("pick_points")
            .Detail("length", count)
            .Detail("limit", 2 * kMaxPicks));
  }
  std::vector<Complex> picks = Points(numbers);
  for (std::size_t i = 0; i < picks.size(); ++i) {
    if (IsFinite(picks[i])) continue;
    return Fail(
        Fault(FaultKind::kNonFiniteTarget, fmt::format("Pick point {} is NaN or infinite.", i))
            .Field(fmt::format("pick_points[{}]", 2 * i))
            .Element(static_cast<std::uint32_t>(i)));
  }
  return picks;
}

std::optional<Pick> FromWire(const v1::PickResult& result) {
  if (!result.hit()) return std::nullopt;
  Pick pick;
  pick.triangle = result.triangle();
  pick.rest = {result.rest().x(), result.rest().y()};
  const auto count = std::min(pick.barycentric.size(), std::size_t(result.barycentric_size()));
  std::copy_n(result.barycentric().begin(), count, pick.barycentric.begin());
  return pick;
}

void ToWire(const std::optional<Pick>& pick, v1::PickResult* out) {
  if (!pick) return;
  out->set_hit(true);
  out->set_triangle(pick->triangle);
  out->mutable_rest()->set_x(pick->rest.real());
  out->mutable_rest()->set_y(pick->rest.imag());
  Append(pick->barycentric, out->mutable_barycentric());
}

ShapeQuality QualityFromWire(const v1::Shape& shape) {
  ShapeQuality quality;
  quality.worst_handle_error = shape.worst_handle_error();
  quality.measured = !shape.unmeasured();
  if (!quality.measured) return quality;
  quality.flipped = shape.flipped_count();
  quality.energy = shape.energy();
  quality.mean_stretch = shape.mean_stretch();
  quality.max_stretch = shape.max_stretch();
  return quality;
}

void ToWire(const ShapeQuality& quality, v1::Shape* out) {
  out->set_worst_handle_error(quality.worst_handle_error);
  out->set_unmeasured(!quality.measured);
  if (!quality.measured) return;
  out->set_flipped_count(quality.flipped);
  out->set_energy(quality.energy);
  out->set_mean_stretch(quality.mean_stretch);
  out->set_max_stretch(quality.max_stretch);
}

}  // namespace arap::convert
