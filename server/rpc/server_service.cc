// ServerService: what a server can do and takes; and the list of all services.
#include <utility>

#include <arap/v1/server_service.grpc.pb.h>

#include "server/rpc/convert_session.h"
#include "server/rpc/handlers.h"
#include "server/rpc/services.h"
#include "server/rpc/unary.h"
#include "server/version.h"

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
                                         "result.float64"};

}  // namespace

Status GetServerInfo(app::Engine& engine, const v1::GetServerInfoRequest&, const Call&,
                     v1::GetServerInfoResponse* response) {
  response->set_version(app::Version());
  const app::Limits& limits = engine.limits;
  v1::Limits& out = *response->mutable_limits();
  out.set_max_vertices(limits.max_vertices);
  out.set_max_triangles(limits.max_triangles);
  out.set_max_handles(limits.max_handles);
  out.set_max_sessions(limits.max_sessions);
  out.set_max_meshes_per_session(limits.max_meshes_per_session);
  out.set_max_handle_sets_per_session(limits.max_handle_sets_per_session);
  out.set_max_message_bytes(limits.max_message_bytes);
  out.set_max_refine(limits.max_refine);
  SetDuration(limits.max_ttl, out.mutable_max_ttl());
  out.set_max_streams(limits.max_streams);
  out.set_max_track_frames(limits.max_track_frames);
  out.set_max_flatten_triangles(limits.max_flatten_triangles);
  out.set_max_cached_surfaces(limits.max_cached_surfaces);
  out.set_max_cached_surface_bytes(limits.max_cached_surface_bytes);
  out.set_max_sessions_per_owner(limits.owner.max_sessions);
  out.set_max_meshes_per_owner(limits.owner.max_meshes);
  out.set_max_handle_sets_per_owner(limits.owner.max_handle_sets);
  out.set_max_bytes_per_owner(limits.owner.max_bytes);
  out.set_max_bytes(limits.max_bytes);
  out.set_max_streams_per_owner(limits.owner.max_streams);
  out.set_max_registrations(limits.max_registrations);
  out.set_max_compilations(limits.max_compilations);
  out.set_max_flattenings(limits.max_flattenings);
  out.set_max_queued_jobs(engine.lanes.queue);
  out.set_max_stream_fps(limits.max_stream_fps);
  SetDuration(limits.max_stream_idle, out.mutable_max_stream_idle());
  out.set_max_stream_load(limits.max_stream_load);
  for (const char* capability : kCapabilities) response->add_capabilities(capability);
  response->set_workers(static_cast<std::uint32_t>(engine.interactive.threads()));
  return {};
}

namespace {

class ServerServiceImpl final : public v1::ServerService::CallbackService {
 public:
  explicit ServerServiceImpl(const Backend& backend) : backend_(backend) {}

  grpc::ServerUnaryReactor* GetServerInfo(grpc::CallbackServerContext* context,
                                          const v1::GetServerInfoRequest* request,
                                          v1::GetServerInfoResponse* response) override {
    return Run(backend_, {"GetServerInfo", Cost::kTrivial, true, nullptr, true}, context, request,
               response, rpc::GetServerInfo);
  }

 private:
  const Backend backend_;
};

}  // namespace

NamedService MakeServerService(const Backend& backend) {
  return {v1::ServerService::service_full_name(), std::make_unique<ServerServiceImpl>(backend)};
}

std::vector<NamedService> MakeServices(app::Engine& engine, const Identity& identity) {
  const Backend backend{engine, identity};
  std::vector<NamedService> services;
  services.push_back(MakeDeformationService(backend));
  services.push_back(MakeFlatteningService(backend));
  services.push_back(MakeServerService(backend));
  return services;
}

}  // namespace arap::rpc
