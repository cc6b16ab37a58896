// The unary RPCs as functions: check and convert, use the app, convert back. None of them blocks on
// anything but its own work; services.cc says on which lane each runs. On a fault the response is
// unused.
#pragma once

#include "arap/base/result.h"
#include "server/rpc/call.h"

namespace arap::app {
struct Engine;
}
namespace arap::v1 {
class CompileHandlesRequest;
class CompileHandlesResponse;
class CreateSessionRequest;
class CreateSessionResponse;
class DeformRequest;
class DeformResponse;
class DeleteHandleSetRequest;
class DeleteHandleSetResponse;
class DeleteMeshRequest;
class DeleteMeshResponse;
class DeleteSessionRequest;
class DeleteSessionResponse;
class EditHandlesRequest;
class EditHandlesResponse;
class FlattenRequest;
class FlattenResponse;
class GetHandleSetRequest;
class GetHandleSetResponse;
class GetMeshRequest;
class GetMeshResponse;
class GetServerInfoRequest;
class GetServerInfoResponse;
class GetSessionRequest;
class GetSessionResponse;
class ListSessionsRequest;
class ListSessionsResponse;
class RegisterMeshRequest;
class RegisterMeshResponse;
}  // namespace arap::v1

namespace arap::rpc {

// session_handlers.cc
Status CreateSession(app::Engine& engine, const v1::CreateSessionRequest& request, const Call& call,
                     v1::CreateSessionResponse* response);
Status GetSession(app::Engine& engine, const v1::GetSessionRequest& request, const Call& call,
                  v1::GetSessionResponse* response);
Status ListSessions(app::Engine& engine, const v1::ListSessionsRequest& request, const Call& call,
                    v1::ListSessionsResponse* response);
Status DeleteSession(app::Engine& engine, const v1::DeleteSessionRequest& request, const Call& call,
                     v1::DeleteSessionResponse* response);

// mesh_handlers.cc
Status RegisterMesh(app::Engine& engine, const v1::RegisterMeshRequest& request, const Call& call,
                    v1::RegisterMeshResponse* response);
Status GetMesh(app::Engine& engine, const v1::GetMeshRequest& request, const Call& call,
               v1::GetMeshResponse* response);
Status DeleteMesh(app::Engine& engine, const v1::DeleteMeshRequest& request, const Call& call,
                  v1::DeleteMeshResponse* response);

// handle_set_handlers.cc
Status CompileHandles(app::Engine& engine, const v1::CompileHandlesRequest& request,
                      const Call& call, v1::CompileHandlesResponse* response);
Status EditHandles(app::Engine& engine, const v1::EditHandlesRequest& request, const Call& call,
                   v1::EditHandlesResponse* response);
Status GetHandleSet(app::Engine& engine, const v1::GetHandleSetRequest& request, const Call& call,
                    v1::GetHandleSetResponse* response);
Status DeleteHandleSet(app::Engine& engine, const v1::DeleteHandleSetRequest& request,
                       const Call& call, v1::DeleteHandleSetResponse* response);

// deform_handler.cc, flatten_handler.cc, info_handler.cc
Status Deform(app::Engine& engine, const v1::DeformRequest& request, const Call& call,
              v1::DeformResponse* response);
Status Flatten(app::Engine& engine, const v1::FlattenRequest& request, const Call& call,
               v1::FlattenResponse* response);
Status GetServerInfo(app::Engine& engine, const v1::GetServerInfoRequest& request, const Call& call,
                     v1::GetServerInfoResponse* response);

}  // namespace arap::rpc
