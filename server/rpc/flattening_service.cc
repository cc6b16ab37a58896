// FlatteningService: Flatten with its handler.
#include <utility>

#include <arap/v1/flattening_service.grpc.pb.h>

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

class FlatteningServiceImpl final : public v1::FlatteningService::CallbackService {
 public:
  explicit FlatteningServiceImpl(const Backend& backend) : backend_(backend) {}

  grpc::ServerUnaryReactor* Flatten(grpc::CallbackServerContext* context,
                                    const v1::FlattenRequest* request,
                                    v1::FlattenResponse* response) override {
    return Run(backend_, {"Flatten", Cost::kHeavy, false, &backend_.engine.flattenings}, context,
               request, response, rpc::Flatten);
  }

 private:
  const Backend backend_;
};

}  // namespace

NamedService MakeFlatteningService(const Backend& backend) {
  return {v1::FlatteningService::service_full_name(),
          std::make_unique<FlatteningServiceImpl>(backend)};
}

}  // namespace arap::rpc
