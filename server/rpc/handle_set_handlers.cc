#include <arap/v1/deformation_service.pb.h>

#include "server/engine.h"
#include "server/rpc/convert_handles.h"
#include "server/rpc/convert_session.h"
#include "server/rpc/handlers.h"
#include "server/runtime/metrics.h"
#include "server/runtime/stopwatch.h"
#include "server/sessions/handle_sets.h"
#include "server/sessions/warm.h"

namespace arap::rpc {
namespace {

// The two answers have the same fields.
template <class Response>
void Answer(const app::HandleSetEntry& entry, const Call& call, const runtime::Stopwatch& working,
            Response* response) {
  ToWire(entry, response->mutable_handle_set());
  SetMicros(call.queue_micros, response->mutable_queue_time());
  SetMicros(working.Micros(), response->mutable_solve_time());
}

}  // namespace

Status CompileHandles(app::Engine& engine, const v1::CompileHandlesRequest& request,
                      const Call& call, v1::CompileHandlesResponse* response) {
  const runtime::Stopwatch working;
  auto handles = FromWire(request.handles(), "handles");
  if (!handles) return Fail(std::move(handles.error()));
  auto entry = app::CompileHandles(engine, call.caller, request.session_id(), request.mesh_id(),
                                   request.handle_set_id(), *handles, call.cancel);
  if (!entry) return Fail(std::move(entry.error()));
  engine.metrics.Phase(runtime::Phase::kCompile, working.Micros() * 1e-6);
  Answer(*entry, call, working, response);
  return {};
}

Status EditHandles(app::Engine& engine, const v1::EditHandlesRequest& request, const Call& call,
                   v1::EditHandlesResponse* response) {
  const runtime::Stopwatch working;
  auto add = FromWire(request.add(), "add");
  if (!add) return Fail(std::move(add.error()));
  auto entry =
      app::EditHandles(engine, call.caller, request.session_id(), request.handle_set_id(),
                       {request.remove().begin(), request.remove().end()}, *add, call.cancel);
  if (!entry) return Fail(std::move(entry.error()));
  engine.metrics.Phase(runtime::Phase::kEdit, working.Micros() * 1e-6);
  Answer(*entry, call, working, response);
  return {};
}

Status GetHandleSet(app::Engine& engine, const v1::GetHandleSetRequest& request, const Call& call,
                    v1::GetHandleSetResponse* response) {
  auto session = SessionOf(engine, call, request.session_id());
  if (!session) return Fail(std::move(session.error()));
  auto entry =
      app::WarmHandleSet(engine, call.caller, **session, request.handle_set_id(), call.cancel);
  if (!entry) return Fail(std::move(entry.error()));
  ToWire(*entry, response->mutable_handle_set());
  return {};
}

Status DeleteHandleSet(app::Engine& engine, const v1::DeleteHandleSetRequest& request,
                       const Call& call, v1::DeleteHandleSetResponse*) {
  return app::DeleteHandleSet(engine, call.caller, request.session_id(), request.handle_set_id());
}

}  // namespace arap::rpc
