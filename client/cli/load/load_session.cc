#include "client/cli/load/load_session.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "client/src/answers.h"
#include "client/src/calls.h"
#include "core/base/try.h"
#include "proto/convert/deform.h"
#include "proto/convert/mesh.h"

namespace arap::cli {
namespace {

using client::internal::Call;
using DeformationStub = v1::DeformationService::Stub;

constexpr std::size_t kCallers = 8;
constexpr std::size_t kSessionIdBytes = 16;

// Does the work of 0 to `count` - 1, some at a time.
void ForEach(std::size_t count, const std::function<void(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < std::min(kCallers, count); ++t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// A session with the mesh and the handles; its id is there from the moment that it exists.
Status FurnishSession(LoadSession& session, const LoadScene& scene,
                      const v1::RegisterMeshRequest& mesh, const client::CallOptions& call) {
  const auto channel = session.connection->Get().first;
  DeformationStub& stub = channel->deformation();
  const std::string id = client::internal::RandomHex(kSessionIdBytes);
  v1::CreateSessionRequest create;
  create.set_session_id(id);
  TRY(const v1::CreateSessionResponse created,
      Call(stub.async(), &DeformationStub::async::CreateSession, create, client::internal::kLookUp,
           call, id));
  CHECK_OK(client::internal::FromWire(created.session(), id));
  session.id = id;

  v1::RegisterMeshRequest with_id = mesh;
  with_id.set_session_id(id);
  TRY(const v1::RegisterMeshResponse registered,
      Call(stub.async(), &DeformationStub::async::RegisterMesh, with_id, client::internal::kWork,
           call, id));
  TRY(const client::MeshInfo info, client::internal::FromWire(registered.mesh(), {}, &scene.mesh));
  session.mesh_id = info.id;

  v1::CompileHandlesRequest compile;
  compile.set_session_id(id);
  compile.set_handle_set_id(kLoadSet);
  compile.set_mesh_id(info.id);
  for (const Handle& handle : scene.handles) convert::ToWire(handle, compile.add_handles());
  TRY(const v1::CompileHandlesResponse compiled,
      Call(stub.async(), &DeformationStub::async::CompileHandles, compile, client::internal::kWork,
           call, id));
  return client::internal::FromWire(
             compiled.handle_set(), {kLoadSet, info.id, scene.handles, true},
             client::internal::MeshSize{scene.mesh.vertices.size(), scene.mesh.triangles.size()})
      .map([](const client::HandleSetInfo&) {});
}

void DeleteSession(const LoadSession& session, const client::CallOptions& call) {
  v1::DeleteSessionRequest request;
  request.set_session_id(session.id);
  const auto channel = session.connection->Get().first;
  (void)Call(channel->deformation().async(), &DeformationStub::async::DeleteSession, request,
             client::internal::kRemove, call, session.id);
}

}  // namespace

std::pair<std::shared_ptr<LoadConnection::Channel>, std::uint64_t> LoadConnection::Get() const {
  const MutexLock lock(&mutex_);
  return {channel_, number_};
}

void LoadConnection::Replace(std::uint64_t number) {
  const MutexLock lock(&mutex_);
  if (number != number_) return;
  channel_ = channel_->Another();
  ++number_;
}

std::vector<LoadSession> OpenLoadSessions(std::size_t count,
                                          const std::function<LoadConnection&(std::size_t)>& of,
                                          const LoadScene& scene, const client::CallOptions& call,
                                          const std::function<void(const Fault&)>& told) {
  v1::RegisterMeshRequest mesh;
  convert::ToWire(scene.mesh, mesh.mutable_mesh());
  convert::ToWire(EnergyOptions{}, mesh.mutable_energy());
  std::vector<LoadSession> sessions(count);
  ForEach(count, [&](std::size_t i) {
    LoadSession& session = sessions[i];
    session.connection = &of(i);
    if (call.stop.stop_requested()) return;
    const Status furnished = FurnishSession(session, scene, mesh, call);
    if (furnished) return;
    told(furnished.error());
    if (!session.id.empty()) DeleteSession(session, call);
    session.id.clear();
  });
  return sessions;
}

void DeleteLoadSessions(const std::vector<LoadSession>& sessions, const client::CallOptions& call) {
  ForEach(sessions.size(), [&](std::size_t i) {
    if (!sessions[i].id.empty()) DeleteSession(sessions[i], call);
  });
}

}  // namespace arap::cli
