// WireTest: a server in this process on a free port, its generated stubs as client, and small
// meshes.
#pragma once

#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <arap/v1/deformation_service.grpc.pb.h>
#include <arap/v1/flattening_service.grpc.pb.h>
#include <arap/v1/server_service.grpc.pb.h>
#include <google/rpc/status.pb.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include "server/host/host.h"
#include "server/runtime/worker_pool.h"
#include "tests/support/fake_clock.h"

namespace arap::wire {

// An error of the wire, its details decoded.
struct WireError {
  int code = 0;
  std::string message;
  std::string reason;
  std::string domain;
  std::map<std::string, std::string> metadata;
  std::vector<std::string> fields;
  double retry_seconds = 0;  // 0: no RetryInfo
};

WireError Decode(const google::rpc::Status& status);
WireError Decode(const grpc::Status& status);

// Expects code and reason, the domain "arapd" and a message; returns the rest for more.
WireError ExpectError(const grpc::Status& status, grpc::StatusCode code, const char* reason);
WireError ExpectError(const google::rpc::Status& status, grpc::StatusCode code, const char* reason);

// The answer of grpc.health.v1.Health/Check, as bytes: 08 01 is SERVING, 08 02 NOT_SERVING.
std::string Health(const std::string& address, const std::string& service = {});

// Keeps every thread of a pool busy, and every visitor's place, from construction until Open or
// destruction, which are in one thread.
class PoolGate {
 public:
  explicit PoolGate(runtime::WorkerPool& pool);
  ~PoolGate() { Open(); }
  PoolGate(const PoolGate&) = delete;
  PoolGate& operator=(const PoolGate&) = delete;
  void Open();

 private:
  std::promise<void> open_;
  std::vector<runtime::WorkerPool::Visit> visits_;
  bool opened_ = false;
};

// width × height unit squares, each two triangles; vertex (x, y) has the index y·(width + 1) + x.
v1::PlanarMesh Grid(int width, int height);

v1::Handle VertexHandle(const std::string& id, std::uint32_t vertex);
v1::HandleTarget TargetAt(const std::string& id, double x, double y);

class WireTest : public ::testing::Test {
 protected:
  using Deformation = v1::DeformationService::Stub;

  WireTest();

  // Before the first use of a stub: changes what the server starts with.
  host::HostOptions& options() { return options_; }
  runtime::FakeClock& clock() { return *clock_; }
  host::Host& host();
  Deformation& deformation();
  v1::FlatteningService::Stub& flattening();
  v1::ServerService::Stub& server();

  template <class Request, class Response>
  grpc::Status Call(grpc::Status (Deformation::*method)(grpc::ClientContext*, const Request&,
                                                        Response*),
                    const Request& request, Response* response) {
    grpc::ClientContext context;
    SetDeadline(context);
    return (deformation().*method)(&context, request, response);
  }

  // So that a broken server fails a test instead of hanging it.
  static void SetDeadline(grpc::ClientContext& context);

  grpc::Status CreateSession(const std::string& id, std::int64_t ttl_seconds = 0);
  grpc::Status Register(const std::string& session, const std::string& mesh,
                        const v1::PlanarMesh& planar, v1::RegisterMeshResponse* response = nullptr);
  grpc::Status Compile(const std::string& session, const std::string& mesh, const std::string& set,
                       const std::vector<v1::Handle>& handles,
                       v1::CompileHandlesResponse* response = nullptr);
  grpc::Status Deform(const std::string& session, const std::string& set,
                      const std::vector<v1::HandleTarget>& targets,
                      v1::DeformResponse* response = nullptr);

  // Session "s" with the 4 × 4 grid as "m" and the set "h": handles "a", "b", "c" at three corners:
  // vertices 0 (0,0), 4 (4,0) and 20 (0,4).
  void SetUpCorners();

 private:
  void Start();

  host::HostOptions options_;
  std::shared_ptr<runtime::FakeClock> clock_ = std::make_shared<runtime::FakeClock>();
  std::unique_ptr<host::Host> host_;
  std::unique_ptr<Deformation> deformation_;
  std::unique_ptr<v1::FlatteningService::Stub> flattening_;
  std::unique_ptr<v1::ServerService::Stub> server_;
};

// The client's end of one StreamDeform.
class DeformStream {
 public:
  explicit DeformStream(v1::DeformationService::Stub& stub);

  void Send(const v1::StreamDeformRequest& request) { EXPECT_TRUE(stream_->Write(request)); }
  void Open(const std::string& session, const std::string& set, v1::Delivery delivery);
  // Open, and expects the answer.
  v1::HandleSetInfo Opened(const std::string& session, const std::string& set,
                           v1::Delivery delivery);
  void Update(std::uint64_t sequence, const std::vector<v1::HandleTarget>& targets);
  // Sends a ping and expects its pong: the server has then read everything before it.
  void Ping(std::uint64_t nonce);
  void HalfClose() { EXPECT_TRUE(stream_->WritesDone()); }
  void Cancel() { context_.TryCancel(); }

  // The next message; nothing at the end of the stream.
  std::optional<v1::StreamDeformResponse> Read();
  // The next message, which must be a shape or an error.
  v1::Shape ReadShape();
  v1::UpdateError ReadError();
  // Reads nothing more; the status of the stream.
  grpc::Status Finish() { return stream_->Finish(); }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::StreamDeformRequest, v1::StreamDeformResponse>>
      stream_;
};

}  // namespace arap::wire
