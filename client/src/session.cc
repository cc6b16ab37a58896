#include "arap/client/session.h"

#include <utility>

#include "client/src/channel.h"
#include "client/src/convert.h"
#include "core/base/try.h"
#include "proto/convert/handles.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"

namespace arap::client {

using convert::ToWire;
using internal::Call;
using internal::FromWire;
using Stub = v1::DeformationService::Stub;

namespace {

// Compiling and editing answer alike.
template <class Response>
Compilation Compiled(const Response& response) {
  return {FromWire(response.handle_set()), convert::Micros(response.queue_time()),
          convert::Micros(response.solve_time())};
}

}  // namespace

Session::Session(std::shared_ptr<internal::Channel> channel, std::string id)
    : channel_(std::move(channel)), id_(std::move(id)) {}

Result<SessionInfo> Session::Get(const CallOptions& call) const {
  v1::GetSessionRequest request;
  request.set_session_id(id_);
  return Call(channel_->deformation(), &Stub::GetSession, request, call, id_)
      .map([](const v1::GetSessionResponse& response) { return FromWire(response.session()); });
}

Status Session::Delete(const CallOptions& call) const {
  v1::DeleteSessionRequest request;
  request.set_session_id(id_);
  return Call(channel_->deformation(), &Stub::DeleteSession, request, call, id_)
      .map([](const v1::DeleteSessionResponse&) {});
}

Result<Registration> Session::RegisterMesh(const PlanarMesh& mesh, const EnergyOptions& energy,
                                           const std::string& mesh_id,
                                           const CallOptions& call) const {
  v1::RegisterMeshRequest request;
  request.set_session_id(id_);
  request.set_mesh_id(mesh_id);
  ToWire(mesh, request.mutable_mesh());
  ToWire(energy, request.mutable_energy());
  TRY(const v1::RegisterMeshResponse response,
      Call(channel_->deformation(), &Stub::RegisterMesh, request, call, id_));
  return Registration{FromWire(response.mesh()), response.shared(), convert::Micros(response.queue_time()),
                      convert::Micros(response.solve_time())};
}

Result<MeshInfo> Session::GetMesh(const std::string& mesh_id, const CallOptions& call) const {
  v1::GetMeshRequest request;
  request.set_session_id(id_);
  request.set_mesh_id(mesh_id);
  TRY(const v1::GetMeshResponse response,
      Call(channel_->deformation(), &Stub::GetMesh, request, call, id_));
  return FromWire(response.mesh());
}

Status Session::DeleteMesh(const std::string& mesh_id, const CallOptions& call) const {
  v1::DeleteMeshRequest request;
  request.set_session_id(id_);
  request.set_mesh_id(mesh_id);
  return Call(channel_->deformation(), &Stub::DeleteMesh, request, call, id_)
      .map([](const v1::DeleteMeshResponse&) {});
}

Result<Compilation> Session::CompileHandles(const std::string& handle_set_id,
                                            const std::string& mesh_id,
                                            std::span<const Handle> handles,
                                            const CallOptions& call) const {
  v1::CompileHandlesRequest request;
  request.set_session_id(id_);
  request.set_mesh_id(mesh_id);
  request.set_handle_set_id(handle_set_id);
  for (const Handle& handle : handles) ToWire(handle, request.add_handles());
  return Call(channel_->deformation(), &Stub::CompileHandles, request, call, id_)
      .map(&Compiled<v1::CompileHandlesResponse>);
}

Result<Compilation> Session::EditHandles(const std::string& handle_set_id,
                                         std::span<const std::string> remove,
                                         std::span<const Handle> add,
                                         const CallOptions& call) const {
  v1::EditHandlesRequest request;
  request.set_session_id(id_);
  request.set_handle_set_id(handle_set_id);
  request.mutable_remove()->Add(remove.begin(), remove.end());
  for (const Handle& handle : add) ToWire(handle, request.add_add());
  return Call(channel_->deformation(), &Stub::EditHandles, request, call, id_)
      .map(&Compiled<v1::EditHandlesResponse>);
}

Result<HandleSetInfo> Session::GetHandleSet(const std::string& handle_set_id,
                                            const CallOptions& call) const {
  v1::GetHandleSetRequest request;
  request.set_session_id(id_);
  request.set_handle_set_id(handle_set_id);
  return Call(channel_->deformation(), &Stub::GetHandleSet, request, call, id_)
      .map(
          [](const v1::GetHandleSetResponse& response) { return FromWire(response.handle_set()); });
}

Status Session::DeleteHandleSet(const std::string& handle_set_id, const CallOptions& call) const {
  v1::DeleteHandleSetRequest request;
  request.set_session_id(id_);
  request.set_handle_set_id(handle_set_id);
  return Call(channel_->deformation(), &Stub::DeleteHandleSet, request, call, id_)
      .map([](const v1::DeleteHandleSetResponse&) {});
}

Result<Shape> Session::Deform(const std::string& handle_set_id,
                              std::span<const HandleTarget> targets, const ShapeOptions& options,
                              std::span<const Complex> pick_points, const CallOptions& call) const {
  v1::DeformRequest request;
  request.set_session_id(id_);
  request.set_handle_set_id(handle_set_id);
  for (const HandleTarget& target : targets) ToWire(target, request.add_targets());
  internal::ToWire(options, request.mutable_options());
  convert::AppendPoints(pick_points, request.mutable_pick_points());
  TRY(const v1::DeformResponse response,
      Call(channel_->deformation(), &Stub::Deform, request, call, id_));
  return FromWire(response.shape());
}

Status Session::DeformTrack(const std::string& handle_set_id,
                            std::span<const std::string> handle_ids,
                            std::span<const std::vector<Target>> frames,
                            const ShapeOptions& options, const FrameCallback& on_frame,
                            const CallOptions& call) const {
  v1::DeformTrackRequest request;
  request.set_session_id(id_);
  request.set_handle_set_id(handle_set_id);
  request.mutable_handle_ids()->Add(handle_ids.begin(), handle_ids.end());
  for (const std::vector<Target>& frame : frames) {
    ToWire(std::span<const Target>(frame), request.add_frames());
  }
  internal::ToWire(options, request.mutable_options());

  grpc::ClientContext context;
  internal::Prepare(context, call, id_);
  const std::stop_callback cancel(call.stop, [&context] { context.TryCancel(); });
  const auto reader = channel_->deformation().DeformTrack(&context, request);
  std::optional<Fault> stop;
  v1::DeformTrackResponse response;
  while (reader->Read(&response)) {
    // After a stop we still read to the end, so that the call can be finished.
    if (stop) continue;
    Result<Shape> shape = FromWire(response.shape());
    if (!shape) {
      stop = std::move(shape.error());
    } else if (!on_frame(*std::move(shape))) {
      stop = Fault(FaultKind::kCancelled, "The caller stopped the track.");
    }
    if (stop) context.TryCancel();
  }
  const grpc::Status status = reader->Finish();
  if (stop) return Fail(*std::move(stop));
  if (!status.ok()) return Fail(convert::FaultOf(status));
  return {};
}

}  // namespace arap::client
