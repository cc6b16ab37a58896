#include "server/rpc/services.h"

#include <string>

#include <arap/v1/deformation_service.grpc.pb.h>
#include <arap/v1/flattening_service.grpc.pb.h>
#include <arap/v1/server_service.grpc.pb.h>

#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/deform_track.h"
#include "server/rpc/handlers.h"
#include "server/rpc/stream_deform.h"
#include "server/rpc/unary_reactor.h"
#include "server/sessions/names.h"
#include "server/sessions/warm.h"

namespace arap::rpc {
namespace {

template <class Request>
std::string SessionIdOf(const Request& request) {
  if constexpr (requires { request.session_id(); }) {
    return request.session_id();
  } else {
    return {};
  }
}

// What a handler costs decides where it runs.
enum class Cost {
  kTrivial,  // says what is known: at once
  kStore,    // may wait for the store: control
  kLookUp,   // the same, and when what it looks up was evicted: jobs
  kFrame,    // computes a frame: interactive; when what it needs was evicted: jobs
  kHeavy,    // factors or back-substitutions: jobs
};

struct Method {
  const char* name;
  Cost cost;
  bool noisy = false;  // logged at debug only
  app::Gate* gate = nullptr;
  bool open_to_all = false;  // needs no identity
};

// What every service works with.
struct Backend {
  app::Engine& engine;
  const Identity& identity;
};

template <class Request, class Response>
using Handler = Status (*)(app::Engine&, const Request&, const Call&, Response*);

template <class Request>
bool IsWarm(app::Engine& engine, const app::Session& session, const Request& request) {
  if constexpr (requires { request.handle_set_id(); }) {
    return app::IsWarmHandleSet(engine, session, request.handle_set_id());
  } else if constexpr (requires { request.mesh_id(); }) {
    return app::IsWarmMesh(engine, session, request.mesh_id());
  } else {
    return true;
  }
}

// Where the call begins, and where it goes on from there.
template <class Request>
void Route(app::Engine& engine, Cost cost, const app::Caller& caller, const Request& request,
           UnaryJob& job) {
  job.lane = cost == Cost::kTrivial ? nullptr
             : cost == Cost::kHeavy ? &engine.jobs
                                    : &engine.control;
  if constexpr (requires { request.session_id(); }) {
    if (cost != Cost::kLookUp && cost != Cost::kFrame) return;
    runtime::WorkerPool* const warm = cost == Cost::kFrame ? &engine.interactive : nullptr;
    job.session = engine.sessions.Peek(caller.owner, request.session_id());
    if (warm != nullptr && job.session && IsWarm(engine, *job.session, request)) {
      job.lane = warm;
      return;
    }
    job.route = [&engine, &request, warm](Call& call) -> Result<runtime::WorkerPool*> {
      auto session = SessionOf(engine, call, request.session_id());
      if (!session) return Fail(std::move(session.error()));
      call.session = *std::move(session);
      return IsWarm(engine, *call.session, request) ? warm : &engine.jobs;
    };
  }
}

template <class Request, class Response>
grpc::ServerUnaryReactor* Run(const Backend& backend, const Method& method,
                              grpc::CallbackServerContext* context, const Request* request,
                              Response* response, Handler<Request, Response> handler) {
  UnaryJob job{method.name, SessionIdOf(*request),  method.noisy, nullptr, method.gate, {}, {},
               {},          &backend.engine.metrics};
  auto caller = CallerOf(*context, backend.identity);
  // To those who are refused elsewhere, an open method answers as to nobody.
  if (!caller && method.open_to_all) {
    caller = app::Caller{app::kNobody, app::Role::kUser, backend.identity.limits};
  }
  // What is refused takes no place on a lane and looks nothing up.
  if (caller) Route(backend.engine, method.cost, *caller, *request, job);
  job.work = [&engine = backend.engine, request, response, handler](const Call& call) -> Status {
    const std::size_t bytes = request->ByteSizeLong(), most = engine.limits.max_message_bytes;
    if (bytes > most) {
      return Fail(app::TooLarge("The request", "max_message_bytes", bytes, most));
    }
    return handler(engine, *request, call, response);
  };
  return RunUnary(context, caller, std::move(job));
}

using Context = grpc::CallbackServerContext;
using Unary = grpc::ServerUnaryReactor;

class DeformationServiceImpl final : public v1::DeformationService::CallbackService {
 public:
  explicit DeformationServiceImpl(const Backend& backend) : backend_(backend) {}

  Unary* CreateSession(Context* context, const v1::CreateSessionRequest* request,
                       v1::CreateSessionResponse* response) override {
    return Run(backend_, {"CreateSession", Cost::kStore}, context, request, response,
               rpc::CreateSession);
  }
  Unary* GetSession(Context* context, const v1::GetSessionRequest* request,
                    v1::GetSessionResponse* response) override {
    return Run(backend_, {"GetSession", Cost::kStore, true}, context, request, response,
               rpc::GetSession);
  }
  Unary* ListSessions(Context* context, const v1::ListSessionsRequest* request,
                      v1::ListSessionsResponse* response) override {
    return Run(backend_, {"ListSessions", Cost::kStore, true}, context, request, response,
               rpc::ListSessions);
  }
  Unary* DeleteSession(Context* context, const v1::DeleteSessionRequest* request,
                       v1::DeleteSessionResponse* response) override {
    return Run(backend_, {"DeleteSession", Cost::kStore}, context, request, response,
               rpc::DeleteSession);
  }
  Unary* RegisterMesh(Context* context, const v1::RegisterMeshRequest* request,
                      v1::RegisterMeshResponse* response) override {
    return Run(backend_, {"RegisterMesh", Cost::kHeavy, false, &backend_.engine.registrations},
               context, request, response, rpc::RegisterMesh);
  }
  Unary* GetMesh(Context* context, const v1::GetMeshRequest* request,
                 v1::GetMeshResponse* response) override {
    return Run(backend_, {"GetMesh", Cost::kLookUp, true}, context, request, response,
               rpc::GetMesh);
  }
  Unary* DeleteMesh(Context* context, const v1::DeleteMeshRequest* request,
                    v1::DeleteMeshResponse* response) override {
    return Run(backend_, {"DeleteMesh", Cost::kStore}, context, request, response, rpc::DeleteMesh);
  }
  Unary* CompileHandles(Context* context, const v1::CompileHandlesRequest* request,
                        v1::CompileHandlesResponse* response) override {
    return Run(backend_, {"CompileHandles", Cost::kHeavy, false, &backend_.engine.compilations},
               context, request, response, rpc::CompileHandles);
  }
  Unary* EditHandles(Context* context, const v1::EditHandlesRequest* request,
                     v1::EditHandlesResponse* response) override {
    return Run(backend_, {"EditHandles", Cost::kHeavy, false, &backend_.engine.compilations},
               context, request, response, rpc::EditHandles);
  }
  Unary* GetHandleSet(Context* context, const v1::GetHandleSetRequest* request,
                      v1::GetHandleSetResponse* response) override {
    return Run(backend_, {"GetHandleSet", Cost::kLookUp, true}, context, request, response,
               rpc::GetHandleSet);
  }
  Unary* DeleteHandleSet(Context* context, const v1::DeleteHandleSetRequest* request,
                         v1::DeleteHandleSetResponse* response) override {
    return Run(backend_, {"DeleteHandleSet", Cost::kStore}, context, request, response,
               rpc::DeleteHandleSet);
  }
  Unary* Deform(Context* context, const v1::DeformRequest* request,
                v1::DeformResponse* response) override {
    return Run(backend_, {"Deform", Cost::kFrame, true}, context, request, response, rpc::Deform);
  }
  grpc::ServerWriteReactor<v1::DeformTrackResponse>* DeformTrack(
      Context* context, const v1::DeformTrackRequest* request) override {
    return rpc::DeformTrack(backend_.engine, backend_.identity, context, request);
  }
  grpc::ServerBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse>* StreamDeform(
      Context* context) override {
    return rpc::StreamDeform(backend_.engine, backend_.identity, context);
  }

 private:
  const Backend backend_;
};

class FlatteningServiceImpl final : public v1::FlatteningService::CallbackService {
 public:
  explicit FlatteningServiceImpl(const Backend& backend) : backend_(backend) {}

  Unary* Flatten(Context* context, const v1::FlattenRequest* request,
                 v1::FlattenResponse* response) override {
    return Run(backend_, {"Flatten", Cost::kHeavy, false, &backend_.engine.flattenings}, context,
               request, response, rpc::Flatten);
  }

 private:
  const Backend backend_;
};

class ServerServiceImpl final : public v1::ServerService::CallbackService {
 public:
  explicit ServerServiceImpl(const Backend& backend) : backend_(backend) {}

  Unary* GetServerInfo(Context* context, const v1::GetServerInfoRequest* request,
                       v1::GetServerInfoResponse* response) override {
    return Run(backend_, {"GetServerInfo", Cost::kTrivial, true, nullptr, true}, context, request,
               response, rpc::GetServerInfo);
  }

 private:
  const Backend backend_;
};

}  // namespace

std::vector<NamedService> MakeServices(app::Engine& engine, const Identity& identity) {
  const Backend backend{engine, identity};
  std::vector<NamedService> services;
  services.push_back({v1::DeformationService::service_full_name(),
                      std::make_unique<DeformationServiceImpl>(backend)});
  services.push_back({v1::FlatteningService::service_full_name(),
                      std::make_unique<FlatteningServiceImpl>(backend)});
  services.push_back(
      {v1::ServerService::service_full_name(), std::make_unique<ServerServiceImpl>(backend)});
  return services;
}

}  // namespace arap::rpc
