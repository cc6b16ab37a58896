// FlatteningService: Flatten with its handler.
#include <utility>

#include <arap/v1/flattening_service.grpc.pb.h>

#include "arap/core/flattener.h"
#include "core/base/try.h"
#include "proto/convert/flatten.h"
#include "server/flattening/prepared_surfaces.h"
#include "server/rpc/convert.h"
#include "server/rpc/services.h"
#include "server/rpc/unary.h"
#include "server/runtime/clock.h"

namespace arap::rpc {

Status Flatten(app::Engine& engine, const v1::FlattenRequest& request, const Call& call,
               v1::FlattenResponse* response) {
  const runtime::WallTimer working;
  const Limits& limits = engine.limits;
  CHECK_OK(CheckBudget(request, limits));
  TRY(const auto options, FromWire(request, limits.max_refine));
  // Before memory is taken: what is asked amiss stays so however much room there is.
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size() / 3);
  if (auto good = CheckFlattenOptions(options, triangles); !good) {
    return Fail(convert::SpelledForFlatten(std::move(good.error())));
  }
  const MeshLimits bounds{limits.max_vertices, limits.max_triangles};
  TRY(auto mesh, FromWire(request.mesh(), bounds));
  auto answer = engine.surfaces.Flatten(call.caller, request.surface_key(), std::move(mesh),
                                        options, call.cancel);
  if (!answer) return Fail(convert::SpelledForFlatten(std::move(answer.error())));
  CHECK_OK(ToWire(answer->flat, request, response));
  response->set_surface_cached(answer->cached);
  SetMicros(call.queue_micros, response->mutable_queue_time());
  SetMicros(working.Micros(), response->mutable_solve_time());
  return {};
}

namespace {

Expected ExpectFlatten(app::Engine& engine, const app::Session*,
                       const v1::FlattenRequest& request) {
  const auto options = convert::FromWire(request, engine.limits.max_refine);
  if (!options) return {};
  // By lengths alone: as if it were one chart, which is the most that it can take.
  const auto vertices = static_cast<std::size_t>(request.mesh().vertices_size()) / 3;
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size()) / 3;
  return {false, 1e-3 * EstimateFlatten({vertices, triangles, 1, vertices}, *options,
                                        !request.surface_key().empty())
                            .milliseconds};
}

}  // namespace

NamedService MakeFlatteningService(const Backend& backend) {
  auto service = std::make_unique<Methods>(backend, v1::FlatteningService::service_full_name());
  service->Unary({"Flatten", Cost::kHeavy, false, &backend.engine.flattenings}, Flatten,
                 ExpectFlatten);
  return Named(std::move(service));
}

}  // namespace arap::rpc
