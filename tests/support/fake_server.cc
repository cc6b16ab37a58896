#include "tests/support/fake_server.h"

#include <chrono>
#include <utility>

#include "arap/v1/flattening_service.grpc.pb.h"
#include "arap/v1/server_service.grpc.pb.h"
#include "tests/support/fake_state.h"

namespace arap::testing {

using google::protobuf::Message;
using grpc::ServerContext;

class FakeFlattening final : public v1::FlatteningService::Service {
 public:
  explicit FakeFlattening(FakeServer::State& state) : state_(state) {}

  grpc::Status Flatten(ServerContext* context, const v1::FlattenRequest* request,
                       v1::FlattenResponse* response) override {
    return state_.Unary("Flatten", context, *request, response, [&](const auto&) {
      FromAbove(*request, *response);
      return grpc::Status::OK;
    });
  }

  grpc::Status SubmitFlatten(ServerContext* context, const v1::SubmitFlattenRequest* request,
                             v1::SubmitFlattenResponse* response) override {
    return state_.Unary("SubmitFlatten", context, *request, response, [&](const auto& session) {
      const std::lock_guard lock(state_.mutex);
      FromAbove(request->flatten(), state_.results[session + request->job_id()]);
      Describe(request->job_id(), v1::JOB_STATE_WAITING, response->mutable_job());
      return grpc::Status::OK;
    });
  }

  grpc::Status CancelJob(ServerContext* context, const v1::CancelJobRequest* request,
                         v1::CancelJobResponse* response) override {
    return state_.Unary("CancelJob", context, *request, response, [&](const auto&) {
      Describe(request->job_id(), v1::JOB_STATE_CANCELLED, response->mutable_job());
      return grpc::Status::OK;
    });
  }

  grpc::Status WatchJob(ServerContext* context, const v1::WatchJobRequest* request,
                        grpc::ServerWriter<v1::WatchJobResponse>* writer) override {
    if (const auto end = state_.Begin("WatchJob", *context)) return *end;
    for (const v1::JobState state :
         {v1::JOB_STATE_WAITING, v1::JOB_STATE_RUNNING, v1::JOB_STATE_DONE}) {
      v1::WatchJobResponse response;
      Describe(request->job_id(), state, response.mutable_job());
      state_.Changed(response);
      writer->Write(response);
      if (const auto lost = state_.Lost("WatchJob")) return *lost;
    }
    return grpc::Status::OK;
  }

  grpc::Status DownloadResult(ServerContext* context, const v1::DownloadResultRequest* request,
                              grpc::ServerWriter<v1::DownloadResultResponse>* writer) override {
    if (const auto end = state_.Begin("DownloadResult", *context)) return *end;
    const std::string bytes = [&] {
      const std::lock_guard lock(state_.mutex);
      v1::FlattenResponse result = state_.results[request->session_id() + "/" + request->job_id()];
      return result.SerializeAsString();
    }();
    constexpr std::size_t kPiece = 10;
    for (std::size_t at = request->offset(); at < bytes.size(); at += kPiece) {
      v1::DownloadResultResponse piece;
      piece.set_offset(at);
      piece.set_total_bytes(bytes.size());
      piece.set_data(bytes.substr(at, kPiece));
      state_.Changed(piece);
      writer->Write(piece);
      if (const auto lost = state_.Lost("DownloadResult")) return *lost;
    }
    return grpc::Status::OK;
  }

 private:
  static void FromAbove(const v1::FlattenRequest& request, v1::FlattenResponse& response) {
    const v1::SurfaceMesh& mesh = request.mesh();
    for (int v = 0; v < mesh.vertices_size() / 3; ++v) {
      for (const double number : {mesh.vertices(3 * v), mesh.vertices(3 * v + 1)}) {
        if (request.float64()) response.add_uv64(number);
        if (!request.float64()) response.add_uv(static_cast<float>(number));
        if (request.include_first_step()) response.add_first_step_uv(number);
      }
      response.add_uv_vertex(static_cast<std::uint32_t>(v));
    }
    *response.mutable_corner_uv() = mesh.triangles();
    for (int t = 0; t < mesh.triangles_size() / 3; ++t) {
      response.add_triangle_chart(0);
      if (!request.include_singular_values()) continue;
      response.add_singular_values(1);
      response.add_singular_values(1);
    }
    v1::FlatChart& chart = *response.add_charts();
    chart.set_triangle_count(static_cast<std::uint64_t>(mesh.triangles_size() / 3));
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (chart.loops_size() == 0) chart.add_loops();
      chart.mutable_loops(0)->add_uv_indices(mesh.triangles(static_cast<int>(k)));
    }
  }

  static void Describe(const std::string& job_id, v1::JobState state, v1::Job* out) {
    out->set_job_id(job_id);
    out->set_state(state);
    out->set_fraction(state == v1::JOB_STATE_DONE ? 1 : 0);
  }

  FakeServer::State& state_;
};

class FakeInformation final : public v1::ServerService::Service {
 public:
  explicit FakeInformation(FakeServer::State& state) : state_(state) {}

  grpc::Status GetServerInfo(ServerContext* context, const v1::GetServerInfoRequest* request,
                             v1::GetServerInfoResponse* response) override {
    return state_.Unary("GetServerInfo", context, *request, response, [&](const auto&) {
      response->set_version("0.1.0");
      response->set_workers(1);
      return grpc::Status::OK;
    });
  }

 private:
  FakeServer::State& state_;
};

FakeServer::FakeServer() : state_(std::make_unique<State>()) {
  state_->services.push_back(State::MakeDeformation(*state_));
  state_->services.push_back(std::make_unique<FakeFlattening>(*state_));
  state_->services.push_back(std::make_unique<FakeInformation>(*state_));
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &state_->port);
  for (const auto& service : state_->services) builder.RegisterService(service.get());
  state_->server = builder.BuildAndStart();
}

FakeServer::~FakeServer() {
  if (state_->server) state_->server->Shutdown(std::chrono::system_clock::now());
}

std::string FakeServer::address() const { return "127.0.0.1:" + std::to_string(state_->port); }

void FakeServer::ChangeAs(const std::string& type, std::function<void(Message&)> change) {
  const std::lock_guard lock(state_->mutex);
  state_->changes[type] = std::move(change);
}

void FakeServer::Refuse(const std::string& method, std::vector<grpc::Status> statuses) {
  const std::lock_guard lock(state_->mutex);
  state_->refuse[method].assign(statuses.begin(), statuses.end());
}

void FakeServer::LoseTheAnswer(const std::string& method, std::vector<grpc::Status> statuses) {
  const std::lock_guard lock(state_->mutex);
  state_->lose[method].assign(statuses.begin(), statuses.end());
}

void FakeServer::Hush(const std::string& method) {
  const std::lock_guard lock(state_->mutex);
  state_->hushed.insert(method);
}

void FakeServer::AnswerOnlyPings() {
  const std::lock_guard lock(state_->mutex);
  state_->only_pings = true;
}

void FakeServer::AnswerFrames(std::uint64_t count) {
  const std::lock_guard lock(state_->mutex);
  state_->frames = count;
}

int FakeServer::calls(const std::string& method) const {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->calls.find(method);
  return found == state_->calls.end() ? 0 : found->second;
}

std::string FakeServer::header(const std::string& method, const std::string& name) const {
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->headers.find(method);
  if (found == state_->headers.end()) return {};
  const auto value = found->second.find(name);
  return value == found->second.end() ? std::string() : value->second;
}

}  // namespace arap::testing
