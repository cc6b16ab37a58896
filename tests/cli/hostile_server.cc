#include "tests/cli/hostile_server.h"

#include <future>
#include <mutex>
#include <utility>
#include <vector>

namespace arap::cli {

class HostileServer::Services {
 public:
  explicit Services(Script script)
      : script_(std::move(script)),
        deformation_(*this),
        flattening_(*this),
        facts_(*this),
        released_(release_.get_future()) {}

  void Register(grpc::ServerBuilder& builder) {
    builder.RegisterService(&deformation_);
    builder.RegisterService(&flattening_);
    builder.RegisterService(&facts_);
  }

  void Release() { release_.set_value(); }
  grpc::Status Silence() const {
    released_.wait_for(std::chrono::seconds(30));
    return {grpc::StatusCode::UNAVAILABLE, "gone"};
  }

  v1::Shape Shape(std::uint64_t sequence) const {
    v1::Shape shape;
    const std::lock_guard lock(mutex_);
    for (const double x : rest_) shape.add_positions64(x);
    shape.set_sequence(sequence);
    shape.set_max_stretch(1);
    return shape;
  }

 private:
  using Context = grpc::ServerContext;
  using Status = grpc::Status;

  struct Deformation final : v1::DeformationService::Service {
    explicit Deformation(Services& services) : all(services) {}

    Status CreateSession(Context*, const v1::CreateSessionRequest* request,
                         v1::CreateSessionResponse* response) override {
      response->mutable_session()->set_session_id(request->session_id());
      return Status::OK;
    }
    Status DeleteSession(Context*, const v1::DeleteSessionRequest*,
                         v1::DeleteSessionResponse*) override {
      return Status::OK;
    }
    Status RegisterMesh(Context*, const v1::RegisterMeshRequest* request,
                        v1::RegisterMeshResponse* response) override {
      {
        const std::lock_guard lock(all.mutex_);
        all.rest_.assign(request->mesh().vertices().begin(), request->mesh().vertices().end());
      }
      v1::MeshInfo& mesh = *response->mutable_mesh();
      mesh.set_mesh_id("mesh");
      mesh.set_vertex_count(static_cast<std::uint64_t>(request->mesh().vertices_size()) / 2);
      mesh.set_triangle_count(static_cast<std::uint64_t>(request->mesh().triangles_size()) / 3);
      *mesh.mutable_energy() = request->energy();
      return all.script_.mesh ? all.script_.mesh(*response) : Status::OK;
    }
    Status CompileHandles(Context*, const v1::CompileHandlesRequest* request,
                          v1::CompileHandlesResponse* response) override {
      *response->mutable_handle_set() = Set(request->handles());
      const std::lock_guard lock(all.mutex_);
      all.set_ = response->handle_set();
      return Status::OK;
    }
    Status Deform(Context*, const v1::DeformRequest*, v1::DeformResponse* response) override {
      *response->mutable_shape() = all.Shape(0);
      return all.script_.deform ? all.script_.deform(*response) : Status::OK;
    }
    Status DeformTrack(Context*, const v1::DeformTrackRequest* request, Track* track) override {
      if (all.script_.track) return all.script_.track(*request, *track);
      for (int i = 0; i < request->frames_size(); ++i) {
        v1::DeformTrackResponse response;
        *response.mutable_shape() = all.Shape(static_cast<std::uint64_t>(i));
        track->Write(response);
      }
      return Status::OK;
    }
    Status StreamDeform(Context*, Stream* stream) override {
      v1::StreamDeformRequest request;
      if (!stream->Read(&request)) return Status::CANCELLED;
      v1::StreamDeformResponse opened;
      {
        const std::lock_guard lock(all.mutex_);
        *opened.mutable_opened()->mutable_handle_set() = all.set_;
      }
      stream->Write(opened);
      if (all.script_.stream) return all.script_.stream(*stream);
      while (stream->Read(&request)) {
        if (!request.has_update()) continue;
        v1::StreamDeformResponse response;
        *response.mutable_shape() = all.Shape(request.update().sequence());
        stream->Write(response);
      }
      return Status::OK;
    }

    template <class Handles>
    static v1::HandleSetInfo Set(const Handles& handles) {
      v1::HandleSetInfo set;
      set.set_handle_set_id("track");
      set.set_mesh_id("mesh");
      set.set_revision(1);
      for (const v1::Handle& handle : handles) {
        set.add_handles()->set_handle_id(handle.handle_id());
        set.mutable_handles(set.handles_size() - 1)->mutable_rest();
      }
      return set;
    }

    Services& all;
  };

  struct Flattening final : v1::FlatteningService::Service {
    explicit Flattening(Services& services) : all(services) {}
    Status Flatten(Context*, const v1::FlattenRequest* request,
                   v1::FlattenResponse* response) override {
      return all.script_.flatten ? all.script_.flatten(*request, *response) : Status::OK;
    }
    Services& all;
  };

  struct Facts final : v1::ServerService::Service {
    explicit Facts(Services& services) : all(services) {}
    Status GetServerInfo(Context*, const v1::GetServerInfoRequest*,
                         v1::GetServerInfoResponse* response) override {
      return all.script_.info ? all.script_.info(*response) : Status::OK;
    }
    Services& all;
  };

  const Script script_;
  Deformation deformation_;
  Flattening flattening_;
  Facts facts_;
  std::promise<void> release_;
  std::shared_future<void> released_;
  mutable std::mutex mutex_;
  std::vector<double> rest_;
  v1::HandleSetInfo set_;
};

HostileServer::HostileServer(Script script)
    : services_(std::make_unique<Services>(std::move(script))) {
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
  builder.SetMaxReceiveMessageSize(-1);
  services_->Register(builder);
  server_ = builder.BuildAndStart();
}

// Calls that are still open are cancelled at once.
HostileServer::~HostileServer() {
  services_->Release();
  if (server_) server_->Shutdown(std::chrono::system_clock::now());
}

std::string HostileServer::address() const { return "127.0.0.1:" + std::to_string(port_); }
v1::Shape HostileServer::Shape(std::uint64_t sequence) const { return services_->Shape(sequence); }
grpc::Status HostileServer::Silence() const { return services_->Silence(); }

}  // namespace arap::cli
