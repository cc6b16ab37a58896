#include "tests/system/fault/client.h"

#include <poll.h>

namespace arap::fault {

using Stub = v1::DeformationService::Stub;

void SetDeadline(grpc::ClientContext& context, std::chrono::milliseconds timeout) {
  context.set_deadline(std::chrono::system_clock::now() + timeout);
}

FaultClient::FaultClient(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  const auto channel =
      grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
  deformation_ = v1::DeformationService::NewStub(channel);
  flattening_ = v1::FlatteningService::NewStub(channel);
  server_ = v1::ServerService::NewStub(channel);
}

grpc::Status FaultClient::Info() {
  grpc::ClientContext context;
  SetDeadline(context);
  v1::GetServerInfoResponse response;
  return server().GetServerInfo(&context, {}, &response);
}

grpc::Status FaultClient::CreateSession(const std::string& id) {
  v1::CreateSessionRequest request;
  request.set_session_id(id);
  v1::CreateSessionResponse response;
  return Call(&Stub::CreateSession, request, &response);
}

grpc::Status FaultClient::DeleteSession(const std::string& id) {
  v1::DeleteSessionRequest request;
  request.set_session_id(id);
  v1::DeleteSessionResponse response;
  return Call(&Stub::DeleteSession, request, &response);
}

grpc::Status FaultClient::Register(const std::string& session, const std::string& mesh,
                                   const v1::PlanarMesh& planar) {
  v1::RegisterMeshRequest request;
  request.set_session_id(session);
  request.set_mesh_id(mesh);
  *request.mutable_mesh() = planar;
  v1::RegisterMeshResponse response;
  return Call(&Stub::RegisterMesh, request, &response);
}

grpc::Status FaultClient::Compile(const std::string& session, const std::string& mesh,
                                  const std::string& set, const std::vector<v1::Handle>& handles) {
  v1::CompileHandlesRequest request;
  request.set_session_id(session);
  request.set_mesh_id(mesh);
  request.set_handle_set_id(set);
  request.mutable_handles()->Assign(handles.begin(), handles.end());
  v1::CompileHandlesResponse response;
  return Call(&Stub::CompileHandles, request, &response);
}

grpc::Status FaultClient::Deform(const std::string& session, const std::string& set,
                                 const std::vector<v1::HandleTarget>& targets,
                                 v1::DeformResponse* response) {
  v1::DeformRequest request;
  request.set_session_id(session);
  request.set_handle_set_id(set);
  request.mutable_targets()->Assign(targets.begin(), targets.end());
  request.mutable_options()->set_float64(true);
  v1::DeformResponse ignored;
  return Call(&Stub::Deform, request, response != nullptr ? response : &ignored);
}

void FaultClient::SetUp(int n) {
  ASSERT_TRUE(CreateSession("s").ok());
  ASSERT_TRUE(Register("s", "m", wire::Grid(n, n)).ok());
  ASSERT_TRUE(
      Compile("s", "m", "h",
              {wire::VertexHandle("a", 0), wire::VertexHandle("b", static_cast<std::uint32_t>(n))})
          .ok());
}

bool Eventually(const std::function<bool()>& condition, std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    poll(nullptr, 0, 5);
  }
  return true;
}

}  // namespace arap::fault
