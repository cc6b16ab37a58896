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
      const v1::SurfaceMesh& mesh = request->mesh();
      for (int v = 0; v < mesh.vertices_size() / 3; ++v) {
        for (const double number : {mesh.vertices(3 * v), mesh.vertices(3 * v + 1)}) {
          if (request->float64()) response->add_uv64(number);
          if (!request->float64()) response->add_uv(static_cast<float>(number));
          if (request->include_first_step()) response->add_first_step_uv(number);
        }
        response->add_uv_vertex(static_cast<std::uint32_t>(v));
      }
      *response->mutable_corner_uv() = mesh.triangles();
      for (int t = 0; t < mesh.triangles_size() / 3; ++t) {
        response->add_triangle_chart(0);
        if (!request->include_singular_values()) continue;
        response->add_singular_values(1);
        response->add_singular_values(1);
      }
      v1::FlatChart& chart = *response->add_charts();
      chart.set_triangle_count(static_cast<std::uint64_t>(mesh.triangles_size() / 3));
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (chart.loops_size() == 0) chart.add_loops();
        chart.mutable_loops(0)->add_uv_indices(mesh.triangles(static_cast<int>(k)));
      }
      return grpc::Status::OK;
    });
  }

 private:
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
