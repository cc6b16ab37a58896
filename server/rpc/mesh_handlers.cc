#include <arap/v1/deformation_service.pb.h>

#include "server/engine.h"
#include "server/rpc/convert_mesh.h"
#include "server/rpc/convert_session.h"
#include "server/rpc/handlers.h"
#include "server/runtime/metrics.h"
#include "server/runtime/stopwatch.h"
#include "server/sessions/registration.h"
#include "server/sessions/warm.h"

namespace arap::rpc {

Status RegisterMesh(app::Engine& engine, const v1::RegisterMeshRequest& request, const Call& call,
                    v1::RegisterMeshResponse* response) {
  const runtime::Stopwatch working;
  auto mesh = FromWire(request.mesh(), {engine.limits.max_vertices, engine.limits.max_triangles});
  if (!mesh) return Fail(std::move(mesh.error()));
  auto options = FromWire(request.energy(), Weights::kUniform, mesh->triangles.size());
  if (!options) return Fail(std::move(options.error()));
  auto registration = app::RegisterMesh(engine, call.caller, request.session_id(),
                                        request.mesh_id(), *std::move(mesh), *options, call.cancel);
  if (!registration) return Fail(std::move(registration.error()));
  if (!registration->shared) {
    engine.metrics.Phase(runtime::Phase::kRegister, working.Micros() * 1e-6);
  }
  ToWire(registration->entry, response->mutable_mesh());
  response->set_shared(registration->shared);
  SetMicros(call.queue_micros, response->mutable_queue_time());
  SetMicros(working.Micros(), response->mutable_solve_time());
  return {};
}

Status GetMesh(app::Engine& engine, const v1::GetMeshRequest& request, const Call& call,
               v1::GetMeshResponse* response) {
  auto session = SessionOf(engine, call, request.session_id());
  if (!session) return Fail(std::move(session.error()));
  auto entry = app::WarmMesh(engine, call.caller, **session, request.mesh_id(), call.cancel);
  if (!entry) return Fail(std::move(entry.error()));
  ToWire(*entry, response->mutable_mesh());
  return {};
}

Status DeleteMesh(app::Engine& engine, const v1::DeleteMeshRequest& request, const Call& call,
                  v1::DeleteMeshResponse*) {
  return app::DeleteMesh(engine, call.caller, request.session_id(), request.mesh_id());
}

}  // namespace arap::rpc
