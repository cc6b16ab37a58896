#include "tests/system/wire/wire_fixture.h"

#include <chrono>
#include <cstdlib>
#include <utility>

#include <google/rpc/error_details.pb.h>
#include <grpcpp/generic/generic_stub.h>
#include <spdlog/spdlog.h>

#include "tests/support/bounded.h"

namespace arap::wire {

WireError Decode(const google::rpc::Status& status) {
  WireError error;
  error.code = status.code();
  error.message = status.message();
  for (const auto& detail : status.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::BadRequest bad_request;
    google::rpc::RetryInfo retry;
    if (detail.UnpackTo(&info)) {
      error.reason = info.reason();
      error.domain = info.domain();
      error.metadata = {info.metadata().begin(), info.metadata().end()};
    } else if (detail.UnpackTo(&bad_request)) {
      for (const auto& violation : bad_request.field_violations()) {
        error.fields.push_back(violation.field());
      }
    } else if (detail.UnpackTo(&retry)) {
      error.retry_seconds = static_cast<double>(retry.retry_delay().seconds()) +
                            1e-9 * static_cast<double>(retry.retry_delay().nanos());
    } else {
      ADD_FAILURE() << "unknown detail " << detail.type_url();
    }
  }
  return error;
}

WireError Decode(const grpc::Status& status) {
  google::rpc::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  WireError error = Decode(details);
  if (!status.error_details().empty()) {
    EXPECT_EQ(error.code, status.error_code());
    EXPECT_EQ(error.message, status.error_message());
  }
  error.code = status.error_code();
  error.message = status.error_message();
  return error;
}

namespace {

WireError Expect(WireError error, grpc::StatusCode code, const char* reason) {
  EXPECT_EQ(error.code, code) << error.message;
  EXPECT_EQ(error.reason, reason) << error.message;
  EXPECT_EQ(error.domain, "arapd");
  EXPECT_FALSE(error.message.empty());
  // What would never fit says so by saying no time.
  const auto number = [&](const char* name) {
    const auto found = error.metadata.find(name);
    return found == error.metadata.end() ? 0 : std::stoull(found->second);
  };
  const bool never = error.metadata.contains("estimate") && number("estimate") > number("limit");
  const bool passes = code == grpc::RESOURCE_EXHAUSTED || code == grpc::UNAVAILABLE;
  EXPECT_EQ(error.retry_seconds > 0, passes && !never);
  return error;
}

}  // namespace

WireError ExpectError(const grpc::Status& status, grpc::StatusCode code, const char* reason) {
  return Expect(Decode(status), code, reason);
}

WireError ExpectError(const google::rpc::Status& status, grpc::StatusCode code,
                      const char* reason) {
  return Expect(Decode(status), code, reason);
}

std::string Health(const std::string& address, const std::string& service) {
  grpc::GenericStub stub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  // Field 1, a string.
  grpc::Slice request("\x0A" + std::string(1, static_cast<char>(service.size())) + service);
  grpc::ByteBuffer sent(&request, 1);
  grpc::ByteBuffer received;
  grpc::Status status;
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + testing::kLongest);
  grpc::CompletionQueue queue;
  const auto call = stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check", sent, &queue);
  call->StartCall();
  call->Finish(&received, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  grpc::Slice answer;
  if (!status.ok() || !received.DumpToSingleSlice(&answer).ok()) return status.error_message();
  return {answer.begin(), answer.end()};
}

PoolGate::PoolGate(runtime::WorkerPool& pool) {
  // A thread that had a visit has none right after: when there is no leave for so long, there is none.
  constexpr std::chrono::milliseconds kWhile{1};
  for (auto last = std::chrono::steady_clock::now();
       std::chrono::steady_clock::now() - last < kWhile;) {
    auto visit = pool.TryVisit({});
    if (visit == nullptr) continue;
    visits_.push_back(std::move(visit));
    last = std::chrono::steady_clock::now();
  }
  const std::shared_future<void> open = open_.get_future().share();
  for (std::size_t i = 0; i < pool.threads(); ++i) {
    // The last place may be for short jobs only, while others have long ones.
    const double seconds = i + 1 < pool.threads() ? 1e3 : 0;
    // One after the other, so that one thread cannot take two.
    auto started = std::make_shared<std::promise<void>>();
    auto is_started = started->get_future();
    const auto block = [open, started] {
      started->set_value();
      EXPECT_EQ(open.wait_for(testing::kLongest), std::future_status::ready)
          << "nobody opens the gate";
    };
    EXPECT_TRUE(pool.TryPost(block, {{}, 0, seconds}));
    EXPECT_EQ(is_started.wait_for(testing::kLongest), std::future_status::ready)
        << "no thread of the pool is free";
  }
}

void PoolGate::Open() {
  if (std::exchange(opened_, true)) return;
  visits_.clear();
  open_.set_value();
}

v1::PlanarMesh Grid(int width, int height) {
  v1::PlanarMesh mesh;
  for (int y = 0; y <= height; ++y) {
    for (int x = 0; x <= width; ++x) {
      mesh.add_vertices(x);
      mesh.add_vertices(y);
    }
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto corner = static_cast<std::uint32_t>(y * (width + 1) + x);
      const auto above = corner + static_cast<std::uint32_t>(width) + 1;
      for (const std::uint32_t vertex : {corner, corner + 1, above + 1, corner, above + 1, above}) {
        mesh.add_triangles(vertex);
      }
    }
  }
  return mesh;
}

v1::Handle VertexHandle(const std::string& id, std::uint32_t vertex) {
  v1::Handle handle;
  handle.set_handle_id(id);
  handle.set_vertex(vertex);
  return handle;
}

v1::HandleTarget TargetAt(const std::string& id, double x, double y) {
  v1::HandleTarget target;
  target.set_handle_id(id);
  target.set_x(x);
  target.set_y(y);
  return target;
}

WireTest::WireTest() {
  spdlog::set_level(spdlog::level::off);
  options_.listen = {"127.0.0.1:0"};
  options_.clock = clock_;
  options_.sweep = {};  // tests sweep by hand
}

void WireTest::Start() {
  auto host = host::Host::Start(options_);
  if (!host) {
    ADD_FAILURE() << host.error().message;
    std::abort();
  }
  host_ = *std::move(host);
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  const auto channel = grpc::CreateCustomChannel(host_->addresses().front(),
                                                 grpc::InsecureChannelCredentials(), arguments);
  deformation_ = v1::DeformationService::NewStub(channel);
  flattening_ = v1::FlatteningService::NewStub(channel);
  server_ = v1::ServerService::NewStub(channel);
}

host::Host& WireTest::host() {
  if (!host_) Start();
  return *host_;
}

WireTest::Deformation& WireTest::deformation() {
  if (!host_) Start();
  return *deformation_;
}

v1::FlatteningService::Stub& WireTest::flattening() {
  if (!host_) Start();
  return *flattening_;
}

v1::ServerService::Stub& WireTest::server() {
  if (!host_) Start();
  return *server_;
}

void WireTest::SetDeadline(grpc::ClientContext& context) {
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(2));
}

grpc::Status WireTest::CreateSession(const std::string& id, std::int64_t ttl_seconds) {
  v1::CreateSessionRequest request;
  request.set_session_id(id);
  if (ttl_seconds != 0) request.mutable_ttl()->set_seconds(ttl_seconds);
  v1::CreateSessionResponse response;
  return Call(&Deformation::CreateSession, request, &response);
}

grpc::Status WireTest::Register(const std::string& session, const std::string& mesh,
                                const v1::PlanarMesh& planar, v1::RegisterMeshResponse* response) {
  v1::RegisterMeshRequest request;
  request.set_session_id(session);
  request.set_mesh_id(mesh);
  *request.mutable_mesh() = planar;
  v1::RegisterMeshResponse ignored;
  return Call(&Deformation::RegisterMesh, request, response ? response : &ignored);
}

grpc::Status WireTest::Compile(const std::string& session, const std::string& mesh,
                               const std::string& set, const std::vector<v1::Handle>& handles,
                               v1::CompileHandlesResponse* response) {
  v1::CompileHandlesRequest request;
  request.set_session_id(session);
  request.set_mesh_id(mesh);
  request.set_handle_set_id(set);
  request.mutable_handles()->Assign(handles.begin(), handles.end());
  v1::CompileHandlesResponse ignored;
  return Call(&Deformation::CompileHandles, request, response ? response : &ignored);
}

grpc::Status WireTest::Deform(const std::string& session, const std::string& set,
                              const std::vector<v1::HandleTarget>& targets,
                              v1::DeformResponse* response) {
  v1::DeformRequest request;
  request.set_session_id(session);
  request.set_handle_set_id(set);
  request.mutable_targets()->Assign(targets.begin(), targets.end());
  v1::DeformResponse ignored;
  return Call(&Deformation::Deform, request, response ? response : &ignored);
}

void WireTest::SetUpCorners() {
  ASSERT_TRUE(CreateSession("s").ok());
  ASSERT_TRUE(Register("s", "m", Grid(4, 4)).ok());
  ASSERT_TRUE(
      Compile("s", "m", "h", {VertexHandle("a", 0), VertexHandle("b", 4), VertexHandle("c", 20)})
          .ok());
}

DeformStream::DeformStream(v1::DeformationService::Stub& stub) {
  context_.set_deadline(std::chrono::system_clock::now() + std::chrono::minutes(2));
  stream_ = stub.StreamDeform(&context_);
}

void DeformStream::Open(const std::string& session, const std::string& set, v1::Delivery delivery) {
  v1::StreamDeformRequest request;
  request.mutable_open()->set_session_id(session);
  request.mutable_open()->set_handle_set_id(set);
  request.mutable_open()->set_delivery(delivery);
  Send(request);
}

v1::HandleSetInfo DeformStream::Opened(const std::string& session, const std::string& set,
                                       v1::Delivery delivery) {
  Open(session, set, delivery);
  const auto answer = Read();
  EXPECT_TRUE(answer && answer->has_opened());
  return answer ? answer->opened().handle_set() : v1::HandleSetInfo();
}

void DeformStream::Update(std::uint64_t sequence, const std::vector<v1::HandleTarget>& targets) {
  v1::StreamDeformRequest request;
  request.mutable_update()->set_sequence(sequence);
  request.mutable_update()->mutable_targets()->Assign(targets.begin(), targets.end());
  Send(request);
}

void DeformStream::Ping(std::uint64_t nonce) {
  v1::StreamDeformRequest request;
  request.mutable_ping()->set_nonce(nonce);
  Send(request);
  const auto answer = Read();
  ASSERT_TRUE(answer && answer->has_pong());
  EXPECT_EQ(answer->pong().nonce(), nonce);
}

std::optional<v1::StreamDeformResponse> DeformStream::Read() {
  v1::StreamDeformResponse response;
  if (!stream_->Read(&response)) return std::nullopt;
  return response;
}

v1::Shape DeformStream::ReadShape() {
  const auto answer = Read();
  EXPECT_TRUE(answer && answer->has_shape()) << (answer ? answer->ShortDebugString() : "end");
  return answer ? answer->shape() : v1::Shape();
}

v1::UpdateError DeformStream::ReadError() {
  const auto answer = Read();
  EXPECT_TRUE(answer && answer->has_error()) << (answer ? answer->ShortDebugString() : "end");
  return answer ? answer->error() : v1::UpdateError();
}

}  // namespace arap::wire
