#include <arap/v1/flattening_service.pb.h>

#include "server/budget/estimate.h"
#include "server/engine.h"
#include "server/flattening/flatten_surface.h"
#include "server/rpc/convert_flatten.h"
#include "server/rpc/convert_mesh.h"
#include "server/rpc/convert_session.h"
#include "server/rpc/handlers.h"
#include "server/runtime/metrics.h"
#include "server/runtime/stopwatch.h"

namespace arap::rpc {
namespace {

void Measure(const FlattenTimes& times, double micros, runtime::Metrics& metrics) {
  using runtime::Phase;
  metrics.Phase(Phase::kFlatten, micros * 1e-6);
  metrics.Phase(Phase::kFlattenTopology, times.topology * 1e-3);
  metrics.Phase(Phase::kFlattenOrder, times.order * 1e-3);
  metrics.Phase(Phase::kFlattenFactor, times.factor * 1e-3);
  metrics.Phase(Phase::kFlattenSolve, times.solve * 1e-3);
}

}  // namespace

Status Flatten(app::Engine& engine, const v1::FlattenRequest& request, const Call& call,
               v1::FlattenResponse* response) {
  const runtime::Stopwatch working;
  const app::Limits& limits = engine.limits;
  if (auto fits = CheckBudget(request, limits); !fits) return fits;
  auto options = FromWire(request, limits);
  if (!options) return Fail(std::move(options.error()));
  const MeshLimits bounds{limits.max_vertices, limits.max_triangles};
  auto mesh = FromWire(request.mesh(), bounds);
  if (!mesh) return Fail(std::move(mesh.error()));
  auto room = engine.derived.Reserve(call.caller, app::FlatteningBytes(mesh->triangles.size()));
  if (!room) return Fail(std::move(room.error()));
  auto answer = app::FlattenSurface(engine.surfaces, call.caller.owner, request.surface_key(),
                                    *std::move(mesh), *options, bounds, call.cancel);
  if (!answer) return Fail(SpelledForFlatten(std::move(answer.error())));
  Measure(answer->flat.times, working.Micros(), engine.metrics);
  if (auto good = ToWire(answer->flat, request, response); !good) return good;
  response->set_surface_cached(answer->cached);
  SetMicros(call.queue_micros, response->mutable_queue_time());
  SetMicros(working.Micros(), response->mutable_solve_time());
  return {};
}

}  // namespace arap::rpc
