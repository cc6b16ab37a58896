#include "server/rpc/convert.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/flattening_service.pb.h>
#include <fmt/format.h>

#include "arap/core/pick.h"
#include "arap/core/registered_mesh.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "proto/convert/status.h"
#include "server/flattening/flatten_jobs.h"
#include "server/sessions/handle_sets.h"
#include "server/sessions/meshes.h"
#include "server/streams/live_set.h"
#include "server/streams/stream_policy.h"

namespace arap::rpc {

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
  const RepairOptions& repairs = entry.mesh->repairs();
  if (repairs != RepairOptions{}) ToWire(repairs, out->mutable_repair());
}

Result<std::vector<Handle>> FromWire(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                                     std::string_view field) {
  std::vector<Handle> out;
  out.reserve(static_cast<std::size_t>(handles.size()));
  for (int i = 0; i < handles.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", field, i);
    auto handle = CheckName(handles[i].handle_id(), path + ".handle_id").and_then([&] {
      return FromWire(handles[i], path);
    });
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

Result<bool> LatestOnly(v1::Delivery delivery) {
  if (v1::Delivery_IsValid(delivery)) return delivery != v1::DELIVERY_EVERY;
  return Fail(
      Fault(FaultKind::kInvalidOption, "open.delivery has a value that this version does not know.")
          .Field("open.delivery")
          .Detail("value", static_cast<int>(delivery)));
}

void Complete(const app::StreamAnswer& answer, v1::StreamDeformResponse& message) {
  switch (answer.kind) {
    case app::StreamAnswer::Kind::kOpened:
      break;
    case app::StreamAnswer::Kind::kShape:
      message.mutable_shape()->set_sequence(answer.sequence);
      message.mutable_shape()->set_replaced(answer.replaced);
      break;
    case app::StreamAnswer::Kind::kError:
      message.mutable_error()->set_sequence(answer.sequence);
      *message.mutable_error()->mutable_status() = convert::ToRpcStatus(*answer.fault);
      break;
    case app::StreamAnswer::Kind::kPong:
      message.mutable_pong()->set_nonce(answer.nonce);
      break;
  }
}

Result<std::vector<Target>> FromWire(const v1::DeformTrackRequest& request, std::size_t frame,
                                     const std::vector<std::size_t>& order) {
  const std::string path = fmt::format("frames[{}]", frame);
  TRY(const std::vector<Target> columns,
      FromWire(request.frames(static_cast<int>(frame)), order.size(), path));
  const std::string array = path + ".targets";
  std::vector<Target> targets(columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    targets[order[i]] = columns[i];
    auto good = CheckTarget(columns[i], array, i, request.handle_ids(static_cast<int>(i)));
    if (!good) return Fail(std::move(good.error().Detail("frame", frame).Field(path)));
  }
  return targets;
}

app::StreamMessage FromWire(const v1::StreamDeformRequest& request, const Limits& limits) {
  using Request = v1::StreamDeformRequest;
  app::StreamMessage out;
  out.bytes = request.ByteSizeLong();
  if (out.bytes > limits.max_message_bytes) return out;
  switch (request.payload_case()) {
    case Request::kOpen:
      out.payload = app::StreamMessage::Open{};
      break;
    case Request::kUpdate: {
      const v1::HandleUpdate& update = request.update();
      out.payload = app::StreamMessage::Update{
          update.sequence(), FromWire(update.targets()),
          std::span(update.positions().data(), static_cast<std::size_t>(update.positions_size())),
          PicksFromWire(update.pick_points()), update.measure()};
      break;
    }
    case Request::kEdit: {
      const auto& add = request.edit().add();
      out.payload = app::StreamMessage::Edit{
          request.edit().sequence(), static_cast<std::size_t>(add.size()),
          std::any_of(add.begin(), add.end(),
                      [](const v1::Handle& handle) { return handle.area_radius() != 0; })};
      break;
    }
    case Request::kPing:
      out.payload = app::StreamMessage::Ping{request.ping().nonce()};
      break;
    case Request::PAYLOAD_NOT_SET:
      break;
  }
  return out;
}

Result<ShapeOptions> FromWire(const v1::DeformOptions& options, const Limits& limits,
                              const RegisteredMesh& mesh) {
  ShapeOptions out;
  TRY(out.deform, FromWire(options, limits.max_refine));
  TRY(out.format, convert::FormatFromWire(options));
  TRY(out.vertices, convert::SubsetFromWire(options, mesh.mesh().vertices.size()));
  if (options.boundary_only()) out.vertices = mesh.BoundaryVertices();
  out.flipped_ids = options.include_flipped_ids();
  return out;
}

namespace {

Status PositionsToWire(std::span<const Complex> positions, const ShapeOptions& options,
                       v1::Shape* out) {
  if (options.vertices.empty()) return convert::ToWire(positions, options.format, out);
  std::vector<Complex> chosen;
  chosen.reserve(options.vertices.size());
  for (const std::uint32_t v : options.vertices) chosen.push_back(positions[v]);
  return convert::ToWire(std::span<const Complex>(chosen), options.format, out);
}

}  // namespace

Status ToWire(const app::LiveSet& set, const ShapeQuality& quality, const ShapeOptions& options,
              std::span<const Complex> picks, const CancelToken& cancel, const ShapeTimes& times,
              v1::Shape* out, std::size_t lane) {
  const Deformer& deformer = set.deformer();
  const std::span<const Complex> positions = deformer.positions(lane);
  CHECK_OK(PositionsToWire(positions, options, out));
  ToWire(quality, out);
  const auto& handles = deformer.handles()->handles();
  if (!handles.empty()) out->set_worst_handle_id(handles[quality.worst_handle].handle.id);
  if (options.flipped_ids && quality.measured) {
    const std::vector<std::uint32_t> flipped = deformer.FlippedTriangles(lane);
    out->mutable_flipped_ids()->Assign(flipped.begin(), flipped.end());
  }
  TRY(const auto found, FindPicks(*deformer.handles(), positions, picks, cancel));
  for (const auto& pick : found) ToWire(pick, out->add_picks());
  out->set_handle_set_revision(set.entry().revision);
  out->set_queue_micros(times.queue_micros);
  out->set_solve_micros(times.working.Micros() / static_cast<double>(times.shapes));
  return {};
}

void ToWire(const app::JobView& view, v1::Job* out) {
  constexpr v1::JobState kStates[] = {v1::JOB_STATE_WAITING, v1::JOB_STATE_RUNNING,
                                      v1::JOB_STATE_DONE, v1::JOB_STATE_FAILED,
                                      v1::JOB_STATE_CANCELLED};
  out->set_job_id(view.id);
  out->set_state(kStates[static_cast<std::size_t>(view.state)]);
  out->set_phase(view.phase);
  out->set_fraction(view.fraction);
  out->set_place(static_cast<std::uint32_t>(view.place));
  if (!view.ended()) SetMicros(1e6 * view.expected_seconds, out->mutable_expected_end());
  out->set_result_bytes(view.result_bytes);
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
