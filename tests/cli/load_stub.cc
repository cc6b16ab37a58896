#include "tests/cli/load_stub.h"

#include <chrono>
#include <utility>

namespace arap::cli {

class LoadStub::Service final : public v1::DeformationService::Service {
 public:
  explicit Service(LoadStub& stub) : stub_(stub) {}

 private:
  using Context = grpc::ServerContext;
  using Status = grpc::Status;

  Status CreateSession(Context* context, const v1::CreateSessionRequest* request,
                       v1::CreateSessionResponse* response) override {
    if (stub_.admit_) {
      const auto found = context->client_metadata().find("authorization");
      const bool none = found == context->client_metadata().end();
      const Status admitted = stub_.admit_(
          none ? std::string() : std::string(found->second.data(), found->second.size()));
      if (!admitted.ok()) return admitted;
    }
    ++stub_.sessions_;
    response->mutable_session()->set_session_id(request->session_id());
    return Status::OK;
  }
  Status DeleteSession(Context*, const v1::DeleteSessionRequest*,
                       v1::DeleteSessionResponse*) override {
    --stub_.sessions_;
    return Status::OK;
  }
  Status RegisterMesh(Context*, const v1::RegisterMeshRequest* request,
                      v1::RegisterMeshResponse* response) override {
    const std::lock_guard lock(stub_.mutex_);
    stub_.vertices_ = request->mesh().vertices_size() / 2;
    v1::MeshInfo& mesh = *response->mutable_mesh();
    mesh.set_mesh_id("mesh");
    mesh.set_vertex_count(static_cast<std::uint64_t>(stub_.vertices_));
    mesh.set_triangle_count(static_cast<std::uint64_t>(request->mesh().triangles_size()) / 3);
    *mesh.mutable_energy() = request->energy();
    return Status::OK;
  }
  Status CompileHandles(Context*, const v1::CompileHandlesRequest* request,
                        v1::CompileHandlesResponse* response) override {
    v1::HandleSetInfo& set = *response->mutable_handle_set();
    set.set_handle_set_id(request->handle_set_id());
    set.set_mesh_id(request->mesh_id());
    set.set_revision(1);
    for (const v1::Handle& handle : request->handles()) {
      v1::HandleInfo& info = *set.add_handles();
      info.set_handle_id(handle.handle_id());
      info.mutable_rest();
    }
    return Status::OK;
  }
  Status StreamDeform(Context*, Stream* stream) override {
    const std::size_t number = stub_.streams_++;
    Request request;
    if (!stream->Read(&request) || !request.has_open()) return Status::CANCELLED;
    Response opened;
    v1::HandleSetInfo& set = *opened.mutable_opened()->mutable_handle_set();
    set.set_handle_set_id(request.open().handle_set_id());
    set.set_mesh_id("mesh");
    set.set_revision(1);
    stream->Write(opened);
    return stub_.script_(stub_, *stream, number);
  }

  LoadStub& stub_;
};

LoadStub::LoadStub(Script script, Admit admit)
    : script_(std::move(script)),
      admit_(std::move(admit)),
      service_(std::make_unique<Service>(*this)) {
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
  builder.RegisterService(service_.get());
  server_ = builder.BuildAndStart();
}

LoadStub::~LoadStub() {
  if (server_) server_->Shutdown(std::chrono::system_clock::now());
}

std::string LoadStub::address() const { return "127.0.0.1:" + std::to_string(port_); }

void LoadStub::Answer(Stream& stream, const Request& request) const {
  Response response;
  if (request.has_ping()) {
    response.mutable_pong()->set_nonce(request.ping().nonce());
  } else {
    v1::Shape& shape = *response.mutable_shape();
    shape.set_sequence(request.has_edit() ? request.edit().sequence()
                                          : request.update().sequence());
    shape.set_max_stretch(1);
    const std::lock_guard lock(mutex_);
    shape.mutable_positions()->Resize(2 * vertices_, 0);
  }
  stream.Write(response);
}

grpc::Status LoadStub::Serve(Stream& stream) const {
  for (Request request; stream.Read(&request);) Answer(stream, request);
  return grpc::Status::OK;
}

}  // namespace arap::cli
