#include <arap/v1/deformation_service.pb.h>

#include "server/engine.h"
#include "server/rpc/convert_handles.h"
#include "server/rpc/convert_shape.h"
#include "server/rpc/handlers.h"
#include "server/runtime/metrics.h"
#include "server/runtime/stopwatch.h"
#include "server/sessions/warm.h"
#include "server/streams/targets.h"

namespace arap::rpc {

Status Deform(app::Engine& engine, const v1::DeformRequest& request, const Call& call,
              v1::DeformResponse* response) {
  const runtime::Stopwatch working;
  auto session = SessionOf(engine, call, request.session_id());
  if (!session) return Fail(std::move(session.error()));
  auto entry =
      app::WarmHandleSet(engine, call.caller, **session, request.handle_set_id(), call.cancel);
  if (!entry) return Fail(std::move(entry.error()));
  auto options = FromWire(request.options(), engine.limits);
  if (!options) return Fail(std::move(options.error()));
  auto picks = PicksFromWire(request.pick_points());
  if (!picks) return Fail(std::move(picks.error()));
  auto targets = app::CompleteTargets(*entry->handles, FromWire(request.targets()));
  if (!targets) return Fail(std::move(targets.error()));

  Deformer deformer(entry->handles);
  auto quality = deformer.Update(*targets, options->deform);
  if (!quality) return Fail(std::move(quality.error()));
  v1::Shape& shape = *response->mutable_shape();
  if (auto good = ToWire(deformer, *quality, *options, &shape); !good) return good;
  PicksToWire(deformer, *picks, &shape);
  shape.set_handle_set_revision(entry->revision);
  shape.set_queue_micros(call.queue_micros);
  shape.set_solve_micros(working.Micros());
  engine.metrics.Phase(runtime::Phase::kFrame, shape.solve_micros() * 1e-6);
  return {};
}

}  // namespace arap::rpc
