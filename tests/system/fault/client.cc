#include "tests/system/fault/client.h"

#include <utility>

#include <poll.h>

namespace arap::fault {
namespace {

// Adds the bearer token to every call: gRPC's own credentials want TLS for that.
class Bearer final : public grpc::experimental::Interceptor {
 public:
  explicit Bearer(const std::string& header) : header_(header) {}
  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    using Point = grpc::experimental::InterceptionHookPoints;
    if (methods->QueryInterceptionHookPoint(Point::PRE_SEND_INITIAL_METADATA)) {
      methods->GetSendInitialMetadata()->insert({"authorization", header_});
    }
    methods->Proceed();
  }

 private:
  const std::string& header_;
};

// Lives as long as its channel.
class Tokens final : public grpc::experimental::ClientInterceptorFactoryInterface {
 public:
  explicit Tokens(const std::string& token) : header_("Bearer " + token) {}
  grpc::experimental::Interceptor* CreateClientInterceptor(
      grpc::experimental::ClientRpcInfo* /*info*/) override {
    return new Bearer(header_);  // gRPC deletes it
  }

 private:
  const std::string header_;
};

}  // namespace

using Stub = v1::DeformationService::Stub;

void SetDeadline(grpc::ClientContext& context, std::chrono::milliseconds timeout) {
  context.set_deadline(std::chrono::system_clock::now() + timeout);
}

FaultClient::FaultClient(const std::string& address, const std::string& token) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>> tokens;
  if (!token.empty()) tokens.push_back(std::make_unique<Tokens>(token));
  const auto channel = grpc::experimental::CreateCustomChannelWithInterceptors(
      address, grpc::InsecureChannelCredentials(), arguments, std::move(tokens));
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
