// The unary calls on a session.
#include "arap/client/session.h"

#include <utility>

#include "client/src/channel.h"
#include "client/src/convert.h"

namespace arap::client {

using internal::Call;
using internal::FromWire;
using internal::ToWire;
using Stub = v1::DeformationService::Stub;

namespace {

// Compiling and editing answer alike.
template <class Response>
CompiledHandles Compiled(const Response& response) {
  return {FromWire(response.handle_set()), internal::Micros(response.queue_time()),
          internal::Micros(response.solve_time())};
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

Result<RegisteredMesh> Session::RegisterMesh(const PlanarMesh& mesh, const EnergyOptions& energy,
                                             const std::string& mesh_id,
                                             const CallOptions& call) const {
  v1::RegisterMeshRequest request;
  request.set_session_id(id_);
  request.set_mesh_id(mesh_id);
  ToWire(mesh, request.mutable_mesh());
  ToWire(energy, request.mutable_energy());
  return Call(channel_->deformation(), &Stub::RegisterMesh, request, call, id_)
      .map([](const v1::RegisterMeshResponse& response) {
        return RegisteredMesh{FromWire(response.mesh()), response.shared(),
                              internal::Micros(response.queue_time()),
                              internal::Micros(response.solve_time())};
      });
}

Result<MeshInfo> Session::GetMesh(const std::string& mesh_id, const CallOptions& call) const {
  v1::GetMeshRequest request;
  request.set_session_id(id_);
  request.set_mesh_id(mesh_id);
  return Call(channel_->deformation(), &Stub::GetMesh, request, call, id_)
      .map([](const v1::GetMeshResponse& response) { return FromWire(response.mesh()); });
}

Status Session::DeleteMesh(const std::string& mesh_id, const CallOptions& call) const {
  v1::DeleteMeshRequest request;
  request.set_session_id(id_);
  request.set_mesh_id(mesh_id);
  return Call(channel_->deformation(), &Stub::DeleteMesh, request, call, id_)
      .map([](const v1::DeleteMeshResponse&) {});
}

Result<CompiledHandles> Session::CompileHandles(const std::string& handle_set_id,
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

Result<CompiledHandles> Session::EditHandles(const std::string& handle_set_id,
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

}  // namespace arap::client
