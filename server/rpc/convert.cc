#include "server/rpc/convert.h"

#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <variant>

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/flattening_service.pb.h>
#include <fmt/format.h>

#include "arap/core/pick.h"
#include "core/base/names.h"
#include "core/base/try.h"
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
  return Fail(Fault(FaultKind::kInvalidOption, message + ".").Field(field).Detail("value", value));
}

Status CheckAnchor(const TriangleAnchor& anchor, const std::string& field) {
  double sum = 0;
  for (const double weight : anchor.barycentric) {
    // Written so that NaN fails too.
    if (!(weight >= -kBarycentricTolerance && weight <= 1 + kBarycentricTolerance)) {
      return Fail(Fault(FaultKind::kInvalidOption,
                        fmt::format("{} has the weight {}, not between 0 and 1.", field, weight))
                      .Field(field)
                      .Detail("value", weight));
    }
    sum += weight;
  }
  if (std::abs(sum - 1) <= kBarycentricTolerance) return {};
  return Fail(Fault(FaultKind::kInvalidOption, fmt::format("{} sums to {}, not to 1 within {}.",
                                                           field, sum, kBarycentricTolerance))
                  .Field(field)
                  .Detail("value", sum));
}

Status Check(const Handle& handle, const std::string& path) {
  if (const auto* anchor = std::get_if<TriangleAnchor>(&handle.anchor)) {
    CHECK_OK(CheckAnchor(*anchor, path + ".triangle_point.barycentric"));
  }
  if (const auto* anchor = std::get_if<PointAnchor>(&handle.anchor)) {
    const Complex at = anchor->position;
    CHECK_OK(CheckRange(at.real(), -kInfinity, kInfinity, path + ".position.x"));
    CHECK_OK(CheckRange(at.imag(), -kInfinity, kInfinity, path + ".position.y"));
  }
  CHECK_OK(CheckRange(handle.weight, Handle::kMinWeight, Handle::kMaxWeight, path + ".weight"));
  CHECK_OK(CheckRange(handle.area_radius, 0, kInfinity, path + ".area_radius"));
  CHECK_OK(CheckRange(handle.depth, -Handle::kMaxDepth, Handle::kMaxDepth, path + ".depth"));
  return CheckRange(handle.depth_falloff, 0, kInfinity, path + ".depth_falloff");
}

Result<Handle> CheckedFromWire(const v1::Handle& handle, const std::string& path) {
  CHECK_OK(CheckName(handle.handle_id(), path + ".handle_id"));
  TRY(Handle out, FromWire(handle, path));
  CHECK_OK(Check(out, path));
  return out;
}

}  // namespace

Result<app::SessionSpec> FromWire(const v1::CreateSessionRequest& request) {
  using std::chrono::milliseconds;
  constexpr std::int64_t kNanos = 1'000'000'000;
  // The range of google.protobuf.Duration: 10000 years.
  constexpr std::int64_t kMaxDurationSeconds = 315'576'000'000;
  app::SessionSpec spec;
  spec.id = request.session_id();
  spec.labels = {request.labels().begin(), request.labels().end()};
  if (request.has_ttl()) {
    const auto& ttl = request.ttl();
    const bool valid = ttl.seconds() >= 0 && ttl.seconds() <= kMaxDurationSeconds &&
                       ttl.nanos() >= 0 && ttl.nanos() < kNanos;
    // The range is checked in milliseconds; a shorter ttl than that must not become "not set".
    const milliseconds rounded =
        valid ? std::chrono::seconds(ttl.seconds()) + milliseconds(ttl.nanos() / 1'000'000)
              : milliseconds::zero();
    if (rounded == milliseconds::zero()) {
      return Fail(Fault(FaultKind::kInvalidOption, "The ttl is not a time of at least 1 s.")
                      .Field("ttl")
                      .Detail("quota", "max_ttl"));
    }
    spec.ttl = rounded;
  }
  return spec;
}

void ToWire(const app::SessionView& view, v1::Session* out) {
  out->set_session_id(view.spec.id);
  out->set_owner(view.owner);
  ToWire(view.created, out->mutable_create_time());
  ToWire(view.expires, out->mutable_expire_time());
  ToWire(view.spec.ttl, out->mutable_ttl());
  out->mutable_labels()->insert(view.spec.labels.begin(), view.spec.labels.end());
  for (const std::string& id : view.mesh_ids) out->add_mesh_ids(id);
  for (const std::string& id : view.handle_set_ids) out->add_handle_set_ids(id);
}

void ToWire(const app::MeshEntry& entry, v1::MeshInfo* out) {
  const EnergyOptions& energy = entry.mesh->options();
  out->set_mesh_id(entry.mesh_id);
  out->set_content_hash(entry.content_hash);
  ToWire(entry.mesh->report(), out);
  ToWire({energy.basis, energy.weights, {}}, out->mutable_energy());
}

Result<std::vector<Handle>> FromWire(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                                     std::string_view field) {
  std::vector<Handle> out;
  out.reserve(static_cast<std::size_t>(handles.size()));
  for (int i = 0; i < handles.size(); ++i) {
    auto handle = CheckedFromWire(handles[i], fmt::format("{}[{}]", field, i));
    if (!handle) return Fail(handle.error().Element(static_cast<std::uint32_t>(i)));
    out.push_back(*std::move(handle));
  }
  return out;
}

void ToWire(const app::HandleSetEntry& entry, v1::HandleSetInfo* out) {
  const CompiledHandles& handles = *entry.handles;
  out->set_handle_set_id(entry.handle_set_id);
  out->set_mesh_id(entry.mesh_id);
  for (const PlacedHandle& placed : handles.handles()) ToWire(placed, out->add_handles());
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

std::vector<app::NamedTarget> FromWire(
    const google::protobuf::RepeatedPtrField<v1::HandleTarget>& targets) {
  std::vector<app::NamedTarget> out;
  out.reserve(static_cast<std::size_t>(targets.size()));
  for (const v1::HandleTarget& target : targets) {
    out.push_back({target.handle_id(), convert::TargetFromWire(target)});
  }
  return out;
}

Result<std::vector<Target>> FromWire(const v1::TrackFrame& frame, std::size_t index,
                                     const std::vector<std::size_t>& order) {
  const std::string path = fmt::format("frames[{}]", index);
  TRY(const std::vector<Target> columns, FromWire(frame, order.size(), path));
  std::vector<Target> targets(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    targets[order[i]] = columns[i];
    if (auto good = app::CheckTarget(columns[i], fmt::format("{}.targets[{}]", path, i)); !good) {
      return Fail(good.error().Detail("frame", index).Field(path));
    }
  }
  return targets;
}

Result<ShapeOptions> FromWire(const v1::DeformOptions& options, const Limits& limits) {
  TRY(const DeformOptions deform, FromWire(options, limits.max_refine));
  return ShapeOptions{deform, options.float64(), options.include_flipped_ids()};
}

Status ToWire(const Deformer& deformer, const ShapeQuality& quality, const ShapeOptions& options,
              v1::Shape* out, std::size_t lane) {
  CHECK_OK(ToWire(deformer.positions(lane), options.float64, out));
  ToWire(quality, out);
  const auto& handles = deformer.handles()->handles();
  if (!handles.empty()) out->set_worst_handle_id(handles[quality.worst_handle].handle.id);
  if (options.flipped_ids) {
    const std::vector<std::uint32_t> flipped = deformer.FlippedTriangles(lane);
    out->mutable_flipped_ids()->Assign(flipped.begin(), flipped.end());
  }
  return {};
}

Status PicksToWire(const Deformer& deformer, std::span<const Complex> points,
                   const CancelToken& cancel, v1::Shape* out) {
  TRY(const auto picks, FindPicks(*deformer.handles(), deformer.positions(), points, cancel));
  for (const auto& pick : picks) ToWire(pick, out->add_picks());
  return {};
}

Status CheckBudget(const v1::FlattenRequest& request, const Limits& limits) {
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size() / 3);
  const std::size_t limit = limits.max_flatten_triangles;
  if (triangles <= limit) return {};
  return Fail(
      Fault(FaultKind::kLimitExceeded,
            fmt::format("The surface has {} triangles, more than max_flatten_triangles of {}.",
                        triangles, limit))
          .Field("mesh.triangles")
          .Detail("count", triangles)
          .Detail("quota", "max_flatten_triangles")
          .Detail("limit", limit));
}

}  // namespace arap::rpc
