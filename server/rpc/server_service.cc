// ServerService: what a server can do and takes; and the list of all services.
#include <utility>

#include <arap/v1/server_service.grpc.pb.h>
#include <grpcpp/generic/async_generic_service.h>

#include "proto/convert/limits.h"
#include "proto/convert/status.h"
#include "server/engine.h"
#include "server/rpc/connections.h"
#include "server/rpc/services.h"
#include "server/rpc/unary.h"

namespace arap::rpc {
namespace {

constexpr const char* kCapabilities[] = {"basis.edge",          "basis.edge_as_published",
                                         "basis.face",          "basis.vertex",
                                         "weights.uniform",     "weights.cotangent",
                                         "mesh.rigidity",       "handle.hard",
                                         "handle.oriented",     "handle.area",
                                         "handle.depth",        "handle.snap",
                                         "mode.rigid",          "mode.similarity",
                                         "mode.baseline",       "deform.refine",
                                         "deform.track",        "stream.latest",
                                         "stream.every",        "stream.edit",
                                         "deform.pick",         "flatten",
                                         "flatten.refine",      "flatten.lscm",
                                         "flatten.abf",         "flatten.anchors",
                                         "flatten.seams",       "flatten.auto_cut",
                                         "flatten.injective",   "flatten.pins",
                                         "flatten.grain_lines", "flatten.surface_key",
                                         "flatten.drawings",    "result.float64",
                                         "mesh.outline",        "mesh.repair",
                                         "result.origin",       "result.float32_le",
                                         "result.int16_le",     "result.boundary",
                                         "result.subset"};

class UnknownMethods final : public grpc::CallbackGenericService {
 public:
  explicit UnknownMethods(Connections& connections) : connections_(connections) {}

  grpc::ServerGenericBidiReactor* CreateReactor(
      grpc::GenericCallbackServerContext* context) override {
    return new Reactor(connections_.Begin(context->peer(), false));
  }

 private:
  class Reactor final : public grpc::ServerGenericBidiReactor {
   public:
    explicit Reactor(std::shared_ptr<const void> counted) : counted_(std::move(counted)) {
      Finish(convert::ToGrpcStatus({FaultKind::kUnimplemented, "There is no such method."}));
    }
    void OnDone() override { delete this; }

   private:
    const std::shared_ptr<const void> counted_;
  };

  Connections& connections_;
};

}  // namespace

Status GetServerInfo(app::Engine& engine, const v1::GetServerInfoRequest&, const Call&,
                     v1::GetServerInfoResponse* response) {
  response->set_version(app::Version());
  convert::ToWire(engine.limits, response->mutable_limits());
  for (const char* capability : kCapabilities) response->add_capabilities(capability);
  response->set_workers(static_cast<std::uint32_t>(engine.lanes.workers));
  return {};
}

NamedService MakeServerService(const Backend& backend) {
  auto service = std::make_unique<Methods>(backend, v1::ServerService::service_full_name());
  service->Unary({"GetServerInfo", Cost::kTrivial, true, nullptr, true}, GetServerInfo);
  return Named(std::move(service));
}

std::unique_ptr<grpc::CallbackGenericService> MakeUnknownMethods(Connections& connections) {
  return std::make_unique<UnknownMethods>(connections);
}

NamedService Named(std::unique_ptr<Methods> methods) {
  std::string name = methods->service();
  return {std::move(name), std::move(methods)};
}

std::vector<NamedService> MakeServices(app::Engine& engine, const Identity& identity, bool echo) {
  const Backend backend{engine, identity};
  std::vector<NamedService> services;
  services.push_back(MakeDeformationService(backend));
  services.push_back(MakeFlatteningService(backend));
  services.push_back(MakeServerService(backend));
  if (echo) services.push_back(MakeEchoService(backend));
  return services;
}

}  // namespace arap::rpc
