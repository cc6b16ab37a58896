// DeformationService: every method with its handler, what it is expected to take, and which lane it
// runs on.
#include <utility>

#include <arap/v1/deformation_service.grpc.pb.h>

#include "arap/core/cost.h"
#include "core/base/try.h"
#include "proto/convert/deform.h"
#include "proto/convert/mesh.h"
#include "server/access/caller.h"
#include "server/budget/faults.h"
#include "server/rpc/convert.h"
#include "server/rpc/long_calls.h"
#include "server/rpc/services.h"
#include "server/rpc/unary.h"
#include "server/runtime/clock.h"
#include "server/runtime/metrics.h"
#include "server/sessions/handle_sets.h"
#include "server/sessions/meshes.h"
#include "server/streams/live_set.h"
#include "server/streams/targets.h"

namespace arap::rpc {
namespace {

// Whose sessions are meant. `missing` is what somebody hears who may not ask: the same as when
// there is nothing.
Result<std::string> OwnerOf(const Call& call, const std::string& owner, Fault missing) {
  const app::Caller& caller = call.caller;
  if (owner.empty() || owner == caller.owner) return caller.owner;
  if (caller.role == app::Role::kAdmin && app::IsOwner(owner)) return owner;
  return Fail(std::move(missing));
}

// How long the call waited and worked, for the answers that have both.
template <class Response>
void SetTimes(const Call& call, const runtime::WallTimer& working, Response* response) {
  SetMicros(call.queue_micros, response->mutable_queue_time());
  SetMicros(working.Micros(), response->mutable_solve_time());
}

}  // namespace

// Sessions.

Status CreateSession(app::Engine& engine, const v1::CreateSessionRequest& request, const Call& call,
                     v1::CreateSessionResponse* response) {
  TRY(auto spec, FromWire(request));
  TRY(const auto view, engine.sessions.Create(call.caller, std::move(spec)));
  ToWire(view, response->mutable_session());
  return {};
}

Status GetSession(app::Engine& engine, const v1::GetSessionRequest& request, const Call& call,
                  v1::GetSessionResponse* response) {
  TRY(const auto owner,
      OwnerOf(call, request.owner(), app::NotFound("session", request.session_id())));
  TRY(const auto view, engine.sessions.View(owner, request.session_id()));
  ToWire(view, response->mutable_session());
  return {};
}

Status ListSessions(app::Engine& engine, const v1::ListSessionsRequest& request, const Call& call,
                    v1::ListSessionsResponse* response) {
  TRY(const auto owner, OwnerOf(call, request.owner(), app::NotFound("owner", request.owner())));
  TRY(const auto page, engine.sessions.List(owner, request.page_size(), request.page_token()));
  for (const app::SessionView& view : page.sessions) ToWire(view, response->add_sessions());
  response->set_next_page_token(page.next_token);
  return {};
}

Status DeleteSession(app::Engine& engine, const v1::DeleteSessionRequest& request, const Call& call,
                     v1::DeleteSessionResponse*) {
  TRY(const auto owner,
      OwnerOf(call, request.owner(), app::NotFound("session", request.session_id())));
  return engine.sessions.Delete(owner, request.session_id());
}

// Meshes.

Status RegisterMesh(app::Engine& engine, const v1::RegisterMeshRequest& request, const Call& call,
                    v1::RegisterMeshResponse* response) {
  const runtime::WallTimer working;
  TRY(auto mesh,
      FromWire(request.mesh(), {engine.limits.max_vertices, engine.limits.max_triangles}));
  TRY(const auto options, FromWire(request.energy(), EnergyOptions{}));
  TRY(const auto registration,
      app::RegisterMesh(engine, call.caller, request.session_id(), request.mesh_id(),
                        std::move(mesh), options, call.cancel, FromWire(request.repair())));
  ToWire(registration.entry, response->mutable_mesh());
  response->set_shared(registration.shared);
  SetTimes(call, working, response);
  return {};
}

Status MeshOutline(app::Engine& engine, const v1::MeshOutlineRequest& request, const Call& call,
                   v1::MeshOutlineResponse* response) {
  const runtime::WallTimer working;
  TRY(const auto outlines, FromWire(request.outlines(), engine.limits.max_vertices));
  TRY(const auto mesh, app::MeshOutlines(engine, call.caller, outlines,
                                         convert::OptionsFromWire(request), call.cancel));
  ToWire(mesh, response);
  SetTimes(call, working, response);
  return {};
}

Status GetMesh(app::Engine& engine, const v1::GetMeshRequest& request, const Call& call,
               v1::GetMeshResponse* response) {
  TRY(const auto session, SessionOf(engine, call, request.session_id()));
  TRY(const auto entry,
      app::WarmMesh(engine, call.caller, *session, request.mesh_id(), call.cancel));
  ToWire(entry, response->mutable_mesh());
  return {};
}

Status DeleteMesh(app::Engine& engine, const v1::DeleteMeshRequest& request, const Call& call,
                  v1::DeleteMeshResponse*) {
  return app::DeleteMesh(engine, call.caller, request.session_id(), request.mesh_id());
}

// Handle sets.

Status CompileHandles(app::Engine& engine, const v1::CompileHandlesRequest& request,
                      const Call& call, v1::CompileHandlesResponse* response) {
  const runtime::WallTimer working;
  TRY(const auto handles, FromWire(request.handles(), "handles"));
  TRY(const auto entry,
      app::CompileHandles(engine, call.caller, request.session_id(), request.mesh_id(),
                          request.handle_set_id(), handles, call.cancel));
  ToWire(entry, response->mutable_handle_set());
  SetTimes(call, working, response);
  return {};
}

Status EditHandles(app::Engine& engine, const v1::EditHandlesRequest& request, const Call& call,
                   v1::EditHandlesResponse* response) {
  const runtime::WallTimer working;
  TRY(const auto add, FromWire(request.add(), "add"));
  TRY(const auto entry,
      app::EditHandles(engine, call.caller, request.session_id(), request.handle_set_id(),
                       {request.remove().begin(), request.remove().end()}, add, call.cancel));
  ToWire(entry, response->mutable_handle_set());
  SetTimes(call, working, response);
  return {};
}

Status GetHandleSet(app::Engine& engine, const v1::GetHandleSetRequest& request, const Call& call,
                    v1::GetHandleSetResponse* response) {
  TRY(const auto session, SessionOf(engine, call, request.session_id()));
  TRY(const auto entry,
      app::WarmHandleSet(engine, call.caller, *session, request.handle_set_id(), call.cancel));
  ToWire(entry, response->mutable_handle_set());
  return {};
}

Status DeleteHandleSet(app::Engine& engine, const v1::DeleteHandleSetRequest& request,
                       const Call& call, v1::DeleteHandleSetResponse*) {
  return app::DeleteHandleSet(engine, call.caller, request.session_id(), request.handle_set_id());
}

// Shapes.

Status Deform(app::Engine& engine, const v1::DeformRequest& request, const Call& call,
              v1::DeformResponse* response) {
  const runtime::WallTimer working;
  TRY(const auto session, SessionOf(engine, call, request.session_id()));
  TRY(auto entry,
      app::WarmHandleSet(engine, call.caller, *session, request.handle_set_id(), call.cancel));
  TRY(const auto options, FromWire(request.options(), engine.limits, *entry.handles->mesh()));
  TRY(const auto picks, PicksFromWire(request.pick_points()));
  TRY(const auto targets, app::CompleteTargets(*entry.handles, FromWire(request.targets())));

  app::LiveSet set(std::move(entry));
  TRY(const auto quality, set.Move(targets, options.deform, engine.metrics, call.cancel));
  Append(options.vertices, response->mutable_vertices());
  return ToWire(set, quality, options, picks, call.cancel, {call.queue_micros, working},
                response->mutable_shape());
}

// What the calls are expected to take.

namespace {

// Of what is to be built from a mesh that is not in memory: long, and nothing more is known.
constexpr Expected kCold{true, 1};

// What CountRows will find, before the handles are read.
RowCount RowsOf(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                std::size_t vertices) {
  RowCount count;
  for (const v1::Handle& handle : handles) {
    const bool area = handle.area_radius() > 0;
    const std::size_t held = handle.oriented() ? 3 : 1;
    count.rows += area ? vertices : held;
    if (handle.hard() && !area && handle.anchor_case() != v1::Handle::kVertex) count.inside += held;
    if (handle.depth() != 0) ++count.depths;
  }
  return count;
}

// To say that there is no such thing is quick; a session that is not in memory knows nothing.
template <class Peeked, class Estimate>
Expected WhenWarm(const Peeked& peeked, Estimate estimate) {
  if (peeked.warmth == app::Warmth::kMissing) return {};
  if (peeked.warmth == app::Warmth::kCold) return kCold;
  return {false, estimate(peeked)};
}

constexpr auto kNoTime = [](const auto&) { return 0.0; };

Expected ExpectRegistration(app::Engine&, const app::Session*,
                            const v1::RegisterMeshRequest& request) {
  const auto vertices = static_cast<std::size_t>(request.mesh().vertices_size()) / 2;
  return {false, EstimateRegistration(vertices, Basis::kEdge).seconds()};
}

Expected ExpectOutline(app::Engine&, const app::Session*, const v1::MeshOutlineRequest& request) {
  std::size_t points = 0;
  for (const v1::Outline& outline : request.outlines()) {
    points += static_cast<std::size_t>(outline.points_size()) / 2;
  }
  return {false, app::ExpectMeshing(points, convert::OptionsFromWire(request))};
}

Expected ExpectMesh(app::Engine& engine, const app::Session* session,
                    const v1::GetMeshRequest& request) {
  if (session == nullptr) return kCold;
  return WhenWarm(app::PeekMesh(engine, *session, request.mesh_id()), kNoTime);
}

Expected ExpectCompilation(app::Engine& engine, const app::Session* session,
                           const v1::CompileHandlesRequest& request) {
  if (session == nullptr) return kCold;
  return WhenWarm(
      app::PeekMesh(engine, *session, request.mesh_id()), [&](const app::PeekedMesh& peeked) {
        const std::size_t vertices = peeked.mesh->mesh().vertices.size();
        return EstimateCompilation(*peeked.mesh, RowsOf(request.handles(), vertices)).seconds();
      });
}

Expected ExpectEdit(app::Engine& engine, const app::Session* session,
                    const v1::EditHandlesRequest& request) {
  if (session == nullptr) return kCold;
  return WhenWarm(
      app::PeekHandleSet(engine, *session, request.handle_set_id()),
      [&](const app::PeekedSet& peeked) {
        const std::size_t vertices = peeked.handles->mesh()->mesh().vertices.size();
        return EstimateEdit(*peeked.handles, {}, RowsOf(request.add(), vertices)).cost.seconds();
      });
}

Expected ExpectHandleSet(app::Engine& engine, const app::Session* session,
                         const v1::GetHandleSetRequest& request) {
  if (session == nullptr) return kCold;
  return WhenWarm(app::PeekHandleSet(engine, *session, request.handle_set_id()), kNoTime);
}

Expected ExpectFrame(app::Engine& engine, const app::Session* session,
                     const v1::DeformRequest& request) {
  if (session == nullptr) return kCold;
  return WhenWarm(
      app::PeekHandleSet(engine, *session, request.handle_set_id()),
      [&](const app::PeekedSet& peeked) {
        const auto options = convert::FromWire(request.options(), engine.limits.max_refine);
        const auto picks = static_cast<std::size_t>(request.pick_points_size()) / 2;
        return options ? EstimateFrame(*peeked.handles, *options, picks).seconds() : 0.0;
      });
}

}  // namespace

NamedService MakeDeformationService(const Backend& backend) {
  constexpr bool kNoisy = true;
  app::Engine& engine = backend.engine;
  auto service = std::make_unique<Methods>(backend, v1::DeformationService::service_full_name());
  service->Unary({"CreateSession", Cost::kStore}, CreateSession);
  service->Unary({"GetSession", Cost::kStore, kNoisy}, GetSession);
  service->Unary({"ListSessions", Cost::kStore, kNoisy}, ListSessions);
  service->Unary({"DeleteSession", Cost::kStore}, DeleteSession);
  service->Unary({"RegisterMesh", Cost::kHeavy, false, &engine.registrations}, RegisterMesh,
                 ExpectRegistration);
  service->Unary({"MeshOutline", Cost::kHeavy, false, &engine.registrations}, MeshOutline,
                 ExpectOutline);
  service->Unary({"GetMesh", Cost::kLookUp, kNoisy}, GetMesh, ExpectMesh);
  service->Unary({"DeleteMesh", Cost::kStore}, DeleteMesh);
  service->Unary({"CompileHandles", Cost::kHeavy, false, &engine.compilations}, CompileHandles,
                 ExpectCompilation);
  service->Unary({"EditHandles", Cost::kHeavy, false, &engine.compilations}, EditHandles,
                 ExpectEdit);
  service->Unary({"GetHandleSet", Cost::kLookUp, kNoisy}, GetHandleSet, ExpectHandleSet);
  service->Unary({"DeleteHandleSet", Cost::kStore}, DeleteHandleSet);
  service->Unary({"Deform", Cost::kFrame, kNoisy}, Deform, ExpectFrame);
  service->Stream<v1::DeformTrackRequest, v1::DeformTrackResponse>(
      "DeformTrack", [backend](Methods::Context* context) {
        return DeformTrack(backend.engine, backend.identity, context);
      });
  service->Stream<v1::StreamDeformRequest, v1::StreamDeformResponse>(
      "StreamDeform", [backend](Methods::Context* context) {
        return StreamDeform(backend.engine, backend.identity, context);
      });
  return Named(std::move(service));
}

}  // namespace arap::rpc
