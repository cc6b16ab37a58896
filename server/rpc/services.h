// The services of the wire. Each has a file of its name with its methods and their handlers;
// unary.h says what a handler is.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/flattening_service.pb.h>
#include <arap/v1/server_service.pb.h>

#include "arap/base/result.h"

namespace grpc {
class CallbackGenericService;
class Service;
}  // namespace grpc
namespace arap::app {
struct Engine;
}

namespace arap::rpc {

struct Backend;
struct Call;
struct Identity;
class Connections;
class Methods;

struct NamedService {
  std::string name;  // as in the health service, "arap.v1.DeformationService"
  std::unique_ptr<grpc::Service> service;
};

// All of them; EchoService only with `echo`. `engine` and `identity` outlive the services, and they outlive the server that they
// are registered with.
std::vector<NamedService> MakeServices(app::Engine& engine, const Identity& identity, bool echo);

// What answers calls of methods that there are not; counted as all calls are. `connections`
// outlives it.
std::unique_ptr<grpc::CallbackGenericService> MakeUnknownMethods(Connections& connections);

NamedService Named(std::unique_ptr<Methods> methods);
NamedService MakeDeformationService(const Backend& backend);
NamedService MakeFlatteningService(const Backend& backend);
NamedService MakeServerService(const Backend& backend);
NamedService MakeEchoService(const Backend& backend);

// The handlers of the unary RPCs, for whoever calls them without a connection.

// deformation_service.cc
Status CreateSession(app::Engine& engine, const v1::CreateSessionRequest& request, const Call& call,
                     v1::CreateSessionResponse* response);
Status GetSession(app::Engine& engine, const v1::GetSessionRequest& request, const Call& call,
                  v1::GetSessionResponse* response);
Status ListSessions(app::Engine& engine, const v1::ListSessionsRequest& request, const Call& call,
                    v1::ListSessionsResponse* response);
Status DeleteSession(app::Engine& engine, const v1::DeleteSessionRequest& request, const Call& call,
                     v1::DeleteSessionResponse* response);
Status RegisterMesh(app::Engine& engine, const v1::RegisterMeshRequest& request, const Call& call,
                    v1::RegisterMeshResponse* response);
Status MeshOutline(app::Engine& engine, const v1::MeshOutlineRequest& request, const Call& call,
                   v1::MeshOutlineResponse* response);
Status GetMesh(app::Engine& engine, const v1::GetMeshRequest& request, const Call& call,
               v1::GetMeshResponse* response);
Status DeleteMesh(app::Engine& engine, const v1::DeleteMeshRequest& request, const Call& call,
                  v1::DeleteMeshResponse* response);
Status CompileHandles(app::Engine& engine, const v1::CompileHandlesRequest& request,
                      const Call& call, v1::CompileHandlesResponse* response);
Status EditHandles(app::Engine& engine, const v1::EditHandlesRequest& request, const Call& call,
                   v1::EditHandlesResponse* response);
Status GetHandleSet(app::Engine& engine, const v1::GetHandleSetRequest& request, const Call& call,
                    v1::GetHandleSetResponse* response);
Status DeleteHandleSet(app::Engine& engine, const v1::DeleteHandleSetRequest& request,
                       const Call& call, v1::DeleteHandleSetResponse* response);
Status Deform(app::Engine& engine, const v1::DeformRequest& request, const Call& call,
              v1::DeformResponse* response);

// flattening_service.cc
Status Flatten(app::Engine& engine, const v1::FlattenRequest& request, const Call& call,
               v1::FlattenResponse* response);
Status SubmitFlatten(app::Engine& engine, const v1::SubmitFlattenRequest& request, const Call& call,
                     v1::SubmitFlattenResponse* response);
Status GetResult(app::Engine& engine, const v1::GetResultRequest& request, const Call& call,
                 v1::GetResultResponse* response);
Status CancelJob(app::Engine& engine, const v1::CancelJobRequest& request, const Call& call,
                 v1::CancelJobResponse* response);

// server_service.cc
Status GetServerInfo(app::Engine& engine, const v1::GetServerInfoRequest& request, const Call& call,
                     v1::GetServerInfoResponse* response);

}  // namespace arap::rpc
