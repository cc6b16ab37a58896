#include "arap/client/session.h"

#include <memory>
#include <utility>

#include "client/src/answers.h"
#include "client/src/calls.h"
#include "client/src/channel.h"
#include "core/base/try.h"
#include "proto/convert/deform.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"

namespace arap::client {

using convert::ToWire;
using internal::Call;
using internal::FromWire;
using internal::kChange;
using internal::kLookUp;
using internal::kRemove;
using internal::kWork;
using Stub = v1::DeformationService::Stub;

namespace {

// A request of the session.
template <class Request>
Request Of(const std::string& session_id) {
  Request request;
  request.set_session_id(session_id);
  return request;
}

template <class Request>
Request OfSet(const std::string& session_id, const std::string& handle_set_id) {
  auto request = Of<Request>(session_id);
  request.set_handle_set_id(handle_set_id);
  return request;
}

template <class Request>
Request OfMesh(const std::string& session_id, const std::string& mesh_id) {
  auto request = Of<Request>(session_id);
  request.set_mesh_id(mesh_id);
  return request;
}

// The answer about a handle set; remembers which mesh it is on.
Result<HandleSetInfo> SetOf(const v1::HandleSetInfo& set, const internal::SetQuestion& asked,
                            internal::KnownSizes& sizes) {
  TRY(auto info, FromWire(set, asked, sizes.OfMesh(set.mesh_id())));
  sizes.KnowSet(info.id, info.mesh_id);
  return info;
}

// Compiling and editing answer alike.
template <class Response>
Result<Compilation> Compiled(const Response& response, const internal::SetQuestion& asked,
                             internal::KnownSizes& sizes) {
  TRY(auto set, SetOf(response.handle_set(), asked, sizes));
  return Compilation{std::move(set), convert::Micros(response.queue_time()),
                     convert::Micros(response.solve_time())};
}

}  // namespace

Session::Session(std::shared_ptr<internal::Channel> channel, std::string id)
    : channel_(std::move(channel)),
      id_(std::move(id)),
      sizes_(std::make_shared<internal::KnownSizes>()) {}

Result<SessionInfo> Session::Get(const CallOptions& call) const {
  const auto request = Of<v1::GetSessionRequest>(id_);
  TRY(const v1::GetSessionResponse response,
      Call(channel_->deformation().async(), &Stub::async::GetSession, request, kLookUp, call, id_));
  return FromWire(response.session(), id_);
}

Status Session::Delete(const CallOptions& call) const {
  const auto request = Of<v1::DeleteSessionRequest>(id_);
  return Call(channel_->deformation().async(), &Stub::async::DeleteSession, request, kRemove, call,
              id_)
      .map([](const v1::DeleteSessionResponse&) {});
}

Result<Registration> Session::RegisterMesh(const PlanarMesh& mesh, const EnergyOptions& energy,
                                           const std::string& mesh_id, const CallOptions& call,
                                           const RepairOptions& repairs) const {
  auto request = OfMesh<v1::RegisterMeshRequest>(id_, mesh_id);
  ToWire(mesh, request.mutable_mesh());
  ToWire(energy, request.mutable_energy());
  if (repairs != RepairOptions{}) ToWire(repairs, request.mutable_repair());
  TRY(const v1::RegisterMeshResponse response,
      Call(channel_->deformation().async(), &Stub::async::RegisterMesh, request, kWork, call, id_));
  TRY(auto info, FromWire(response.mesh(), mesh_id, &mesh));
  sizes_->Know(info.id, {mesh.vertices.size(), mesh.triangles.size()});
  return Registration{std::move(info), response.shared(), convert::Micros(response.queue_time()),
                      convert::Micros(response.solve_time())};
}

Result<MeshInfo> Session::GetMesh(const std::string& mesh_id, const CallOptions& call) const {
  const auto request = OfMesh<v1::GetMeshRequest>(id_, mesh_id);
  TRY(const v1::GetMeshResponse response,
      Call(channel_->deformation().async(), &Stub::async::GetMesh, request, kLookUp, call, id_));
  TRY(auto info, FromWire(response.mesh(), mesh_id, nullptr));
  sizes_->Know(mesh_id, {info.report.vertices, info.report.triangles});
  return info;
}

Status Session::DeleteMesh(const std::string& mesh_id, const CallOptions& call) const {
  const auto request = OfMesh<v1::DeleteMeshRequest>(id_, mesh_id);
  CHECK_OK(
      Call(channel_->deformation().async(), &Stub::async::DeleteMesh, request, kRemove, call, id_));
  sizes_->Forget(mesh_id);
  return {};
}

Result<Compilation> Session::CompileHandles(const std::string& handle_set_id,
                                            const std::string& mesh_id,
                                            std::span<const Handle> handles,
                                            const CallOptions& call) const {
  auto request = OfSet<v1::CompileHandlesRequest>(id_, handle_set_id);
  request.set_mesh_id(mesh_id);
  for (const Handle& handle : handles) ToWire(handle, request.add_handles());
  TRY(const v1::CompileHandlesResponse response,
      Call(channel_->deformation().async(), &Stub::async::CompileHandles, request, kWork, call,
           id_));
  return Compiled(response, {handle_set_id, mesh_id, handles, true}, *sizes_);
}

Result<Compilation> Session::EditHandles(const std::string& handle_set_id,
                                         std::span<const std::string> remove,
                                         std::span<const Handle> add,
                                         const CallOptions& call) const {
  auto request = OfSet<v1::EditHandlesRequest>(id_, handle_set_id);
  request.mutable_remove()->Add(remove.begin(), remove.end());
  for (const Handle& handle : add) ToWire(handle, request.add_add());
  TRY(const v1::EditHandlesResponse response,
      Call(channel_->deformation().async(), &Stub::async::EditHandles, request, kChange, call,
           id_));
  return Compiled(response, {handle_set_id, {}, add}, *sizes_);
}

Result<HandleSetInfo> Session::GetHandleSet(const std::string& handle_set_id,
                                            const CallOptions& call) const {
  const auto request = OfSet<v1::GetHandleSetRequest>(id_, handle_set_id);
  TRY(const v1::GetHandleSetResponse response,
      Call(channel_->deformation().async(), &Stub::async::GetHandleSet, request, kLookUp, call,
           id_));
  return SetOf(response.handle_set(), {handle_set_id, {}}, *sizes_);
}

Status Session::DeleteHandleSet(const std::string& handle_set_id, const CallOptions& call) const {
  const auto request = OfSet<v1::DeleteHandleSetRequest>(id_, handle_set_id);
  CHECK_OK(Call(channel_->deformation().async(), &Stub::async::DeleteHandleSet, request, kRemove,
                call, id_));
  sizes_->ForgetSet(handle_set_id);
  return {};
}

Result<Shape> Session::Deform(const std::string& handle_set_id,
                              std::span<const HandleTarget> targets, const ShapeOptions& options,
                              std::span<const Complex> pick_points, const CallOptions& call) const {
  auto request = OfSet<v1::DeformRequest>(id_, handle_set_id);
  for (const HandleTarget& target : targets) ToWire(target, request.add_targets());
  internal::ToWire(options, request.mutable_options());
  convert::AppendPoints(pick_points, request.mutable_pick_points());
  TRY(const v1::DeformResponse response,
      Call(channel_->deformation().async(), &Stub::async::Deform, request, kWork, call, id_));
  const auto mesh = sizes_->OfSet(handle_set_id);
  TRY(auto vertices, internal::VerticesFromWire(response.vertices(), options, mesh));
  return FromWire(response.shape(), {options, mesh, pick_points.size(), std::move(vertices),
                                     options.deform.measure_every > 0});
}

}  // namespace arap::client
