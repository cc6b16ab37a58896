// What a FakeServer holds, for the services of which it is made.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <grpcpp/grpcpp.h>

#include "arap/v1/deformation_service.pb.h"
#include "arap/v1/flattening_service.pb.h"
#include "tests/support/fake_server.h"

namespace arap::testing {

struct FakeServer::State {
  // A mesh's handle set.
  struct Set {
    std::string mesh_id;
    std::vector<std::string> handles;
    std::uint64_t revision = 1;
  };

  // fake_deformation.cc
  static std::unique_ptr<grpc::Service> MakeDeformation(State& state);

  // What the beginning of a call comes to: a status, or nothing when it is to be carried out.
  std::optional<grpc::Status> Begin(const std::string& method, grpc::ServerContext& context) {
    {
      const std::lock_guard lock(mutex);
      ++calls[method];
      headers[method].clear();
      for (const auto& [name, value] : context.client_metadata()) {
        headers[method][{name.data(), name.size()}] = {value.data(), value.size()};
      }
      if (auto& refusals = refuse[method]; !refusals.empty()) {
        const grpc::Status status = refusals.front();
        refusals.pop_front();
        return status;
      }
    }
    if (!IsHushed(method)) return std::nullopt;
    while (!context.IsCancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return grpc::Status::CANCELLED;
  }

  bool IsHushed(const std::string& method) const {
    const std::lock_guard lock(mutex);
    return hushed.contains(method);
  }

  void Changed(google::protobuf::Message& answer) const {
    std::function<void(google::protobuf::Message&)> change;
    {
      const std::lock_guard lock(mutex);
      const auto found = changes.find(std::string(answer.GetDescriptor()->full_name()));
      if (found == changes.end()) return;
      change = found->second;
    }
    change(answer);
  }

  // An answer with the shape in it.
  template <class Response>
  Response WithShape(v1::Shape shape) const {
    Changed(shape);
    Response response;
    *response.mutable_shape() = std::move(shape);
    Changed(response);
    return response;
  }

  template <class Request, class Response, class Work>
  grpc::Status Unary(const std::string& method, grpc::ServerContext* context,
                     const Request& request, Response* response, const Work& work) {
    if (const auto end = Begin(method, *context)) return *end;
    const std::string session = [&]() -> std::string {
      if constexpr (requires { request.session_id(); }) return request.session_id() + "/";
      return {};
    }();
    const grpc::Status done = work(session);
    if (!done.ok()) return done;
    Changed(*response);
    return Lost(method).value_or(grpc::Status::OK);
  }

  // How a call ends whose answer, or a piece of it, is lost; nothing when it is not.
  std::optional<grpc::Status> Lost(const std::string& method) {
    const std::lock_guard lock(mutex);
    auto& losses = lose[method];
    if (losses.empty()) return std::nullopt;
    const grpc::Status lost = losses.front();
    losses.pop_front();
    return lost;
  }

  void Describe(const std::string& id, const Set& set, v1::HandleSetInfo* out) const {
    out->set_handle_set_id(id);
    out->set_mesh_id(set.mesh_id);
    for (const std::string& handle : set.handles) out->add_handles()->set_handle_id(handle);
    out->set_row_count(set.handles.size());
    out->set_revision(set.revision);
  }

  void Describe(const std::string& id, const v1::PlanarMesh& mesh, v1::MeshInfo* out) const {
    out->set_mesh_id(id);
    out->set_content_hash(std::string(64, '0'));
    out->set_vertex_count(static_cast<std::uint64_t>(mesh.vertices_size() / 2));
    out->set_triangle_count(static_cast<std::uint64_t>(mesh.triangles_size() / 3));
  }

  v1::Shape Rest(const v1::PlanarMesh& mesh, const Set& set, const v1::DeformOptions& options,
                 int picks) const {
    v1::Shape shape;
    for (const double number : mesh.vertices()) {
      if (options.float64()) {
        shape.add_positions64(number);
      } else {
        shape.add_positions(static_cast<float>(number));
      }
    }
    for (int i = 0; i < picks; ++i) shape.add_picks();
    shape.set_handle_set_revision(set.revision);
    if (!set.handles.empty()) shape.set_worst_handle_id(set.handles.front());
    return shape;
  }

  // The set and its mesh, copied.
  std::optional<std::pair<Set, v1::PlanarMesh>> Find(const std::string& session,
                                                     const std::string& set_id) const {
    const std::lock_guard lock(mutex);
    const auto set = sets.find(session + set_id);
    if (set == sets.end()) return std::nullopt;
    const auto mesh = meshes.find(session + set->second.mesh_id);
    if (mesh == meshes.end()) return std::nullopt;
    return std::pair(set->second, mesh->second);
  }

  mutable std::mutex mutex;
  std::map<std::string, v1::PlanarMesh> meshes;        // by "session/mesh"
  std::map<std::string, Set> sets;                     // by "session/set"
  std::map<std::string, v1::FlattenResponse> results;  // by "session/job"
  std::map<std::string, std::function<void(google::protobuf::Message&)>> changes;
  std::map<std::string, std::deque<grpc::Status>> refuse, lose;
  std::set<std::string> hushed;
  bool only_pings = false;
  std::optional<std::uint64_t> frames;  // of every track
  std::map<std::string, int> calls;
  std::map<std::string, std::map<std::string, std::string>> headers;

  std::vector<std::unique_ptr<grpc::Service>> services;
  int port = 0;
  std::unique_ptr<grpc::Server> server;
};

}  // namespace arap::testing
