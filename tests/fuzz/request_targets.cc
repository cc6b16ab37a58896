// The calls with one request, by family.
#include <chrono>
#include <span>

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/flattening_service.grpc.pb.h>
#include <arap/v1/server_service.pb.h>
#include <grpcpp/support/status.h>

#include "proto/convert/status.h"
#include "server/rpc/services.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/check.h"
#include "tests/fuzz/targets.h"
#include "tests/fuzz/world.h"

namespace arap::fuzz {
namespace {

constexpr int kMaxCalls = 8;

// Inputs seldom guess a name.
template <class Request>
void FillIn(Request& request) {
  if constexpr (requires { request.set_session_id(""); }) request.set_session_id(kSession);
  if constexpr (requires { request.set_mesh_id(""); }) {
    if (request.mesh_id().empty()) request.set_mesh_id(kMesh);
  }
  if constexpr (requires { request.set_handle_set_id(""); }) {
    if (request.handle_set_id().empty()) request.set_handle_set_id(kSet);
  }
  if constexpr (requires { request.set_job_id(""); }) {
    if (request.job_id().empty()) request.set_job_id("j");
  }
}

template <class Request, class Response>
using Handler = Status (*)(app::Engine&, const Request&, const rpc::Call&, Response*);

// One method, from the bytes of its request.
using Method = void (*)(std::span<const std::uint8_t> bytes, bool fill_in);

template <class Request, class Response, Handler<Request, Response> kHandler>
void Handle(std::span<const std::uint8_t> bytes, bool fill_in) {
  Request request;
  if (!request.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return;
  if (fill_in) FillIn(request);
  World& world = World::Get();
  Response response;
  const Status status = kHandler(world.engine(), request, world.call(), &response);
  if (status) {
    CheckFinite(response);
    return;
  }
  CheckFault(status.error());
  const grpc::Status wire = convert::ToGrpcStatus(status.error());
  Promise(!wire.ok(), "a fault is no success on the wire");
  Promise(!wire.error_details().empty(), "a fault has details on the wire");
}

template <class Request, class Response>
using Reading = std::unique_ptr<grpc::ClientReader<Response>> (v1::FlatteningService::Stub::*)(
    grpc::ClientContext*, const Request&);

// A call with an answer in pieces, over the channel within the process.
template <class Request, class Response, Reading<Request, Response> kReading>
void ReadAll(std::span<const std::uint8_t> bytes, bool fill_in) {
  Request request;
  if (!request.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return;
  if (fill_in) FillIn(request);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
  const auto reader = (World::Get().flattening().*kReading)(&context, request);
  Response response;
  while (reader->Read(&response)) CheckFinite(response);
  CheckEnd(reader->Finish());
}

void RunCalls(std::span<const Method> methods, const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  for (int call = 0; call < kMaxCalls && !bytes.empty(); ++call) {
    const std::uint8_t choice = bytes.Byte();
    methods[(choice & 0x7Fu) % methods.size()](bytes.Part(), (choice & 0x80u) != 0);
  }
  World::Get().Reset();
}

}  // namespace

void Session(const std::uint8_t* data, std::size_t size) {
  static constexpr Method kMethods[] = {
      Handle<v1::CreateSessionRequest, v1::CreateSessionResponse, rpc::CreateSession>,
      Handle<v1::GetSessionRequest, v1::GetSessionResponse, rpc::GetSession>,
      Handle<v1::ListSessionsRequest, v1::ListSessionsResponse, rpc::ListSessions>,
      Handle<v1::DeleteSessionRequest, v1::DeleteSessionResponse, rpc::DeleteSession>,
  };
  RunCalls(kMethods, data, size);
}

void Mesh(const std::uint8_t* data, std::size_t size) {
  static constexpr Method kMethods[] = {
      Handle<v1::RegisterMeshRequest, v1::RegisterMeshResponse, rpc::RegisterMesh>,
      Handle<v1::GetMeshRequest, v1::GetMeshResponse, rpc::GetMesh>,
      Handle<v1::DeleteMeshRequest, v1::DeleteMeshResponse, rpc::DeleteMesh>,
      Handle<v1::CompileHandlesRequest, v1::CompileHandlesResponse, rpc::CompileHandles>,
      Handle<v1::DeformRequest, v1::DeformResponse, rpc::Deform>,
      Handle<v1::MeshOutlineRequest, v1::MeshOutlineResponse, rpc::MeshOutline>,
  };
  RunCalls(kMethods, data, size);
}

void Handles(const std::uint8_t* data, std::size_t size) {
  static constexpr Method kMethods[] = {
      Handle<v1::CompileHandlesRequest, v1::CompileHandlesResponse, rpc::CompileHandles>,
      Handle<v1::EditHandlesRequest, v1::EditHandlesResponse, rpc::EditHandles>,
      Handle<v1::GetHandleSetRequest, v1::GetHandleSetResponse, rpc::GetHandleSet>,
      Handle<v1::DeleteHandleSetRequest, v1::DeleteHandleSetResponse, rpc::DeleteHandleSet>,
      Handle<v1::DeformRequest, v1::DeformResponse, rpc::Deform>,
  };
  RunCalls(kMethods, data, size);
}

void Deform(const std::uint8_t* data, std::size_t size) {
  static constexpr Method kMethods[] = {Handle<v1::DeformRequest, v1::DeformResponse, rpc::Deform>};
  RunCalls(kMethods, data, size);
}

void Flatten(const std::uint8_t* data, std::size_t size) {
  using Stub = v1::FlatteningService::Stub;
  static constexpr Method kMethods[] = {
      Handle<v1::FlattenRequest, v1::FlattenResponse, rpc::Flatten>,
      Handle<v1::SubmitFlattenRequest, v1::SubmitFlattenResponse, rpc::SubmitFlatten>,
      Handle<v1::GetResultRequest, v1::GetResultResponse, rpc::GetResult>,
      Handle<v1::CancelJobRequest, v1::CancelJobResponse, rpc::CancelJob>,
      ReadAll<v1::WatchJobRequest, v1::WatchJobResponse, &Stub::WatchJob>,
      ReadAll<v1::DownloadResultRequest, v1::DownloadResultResponse, &Stub::DownloadResult>,
  };
  RunCalls(kMethods, data, size);
}

void Server(const std::uint8_t* data, std::size_t size) {
  static constexpr Method kMethods[] = {
      Handle<v1::GetServerInfoRequest, v1::GetServerInfoResponse, rpc::GetServerInfo>};
  RunCalls(kMethods, data, size);
}

}  // namespace arap::fuzz
