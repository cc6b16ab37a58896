// The DeformationService of a FakeServer.
#include "arap/v1/deformation_service.grpc.pb.h"
#include "proto/convert/status.h"
#include "tests/support/fake_state.h"

namespace arap::testing {

using grpc::ServerContext;
using State = FakeServer::State;

namespace {

grpc::Status Missing(const std::string& what) {
  return convert::ToGrpcStatus(Fault(FaultKind::kNotFound, "There is no " + what + "."));
}

class FakeDeformation final : public v1::DeformationService::Service {
 public:
  explicit FakeDeformation(State& state) : state_(state) {}

  grpc::Status CreateSession(ServerContext* context, const v1::CreateSessionRequest* request,
                             v1::CreateSessionResponse* response) override {
    return state_.Unary("CreateSession", context, *request, response, [&](const auto&) {
      response->mutable_session()->set_session_id(request->session_id());
      return grpc::Status::OK;
    });
  }

  grpc::Status GetSession(ServerContext* context, const v1::GetSessionRequest* request,
                          v1::GetSessionResponse* response) override {
    return state_.Unary("GetSession", context, *request, response, [&](const auto&) {
      response->mutable_session()->set_session_id(request->session_id());
      return grpc::Status::OK;
    });
  }

  grpc::Status ListSessions(ServerContext* context, const v1::ListSessionsRequest* request,
                            v1::ListSessionsResponse* response) override {
    return state_.Unary("ListSessions", context, *request, response, [&](const auto&) {
      response->add_sessions()->set_session_id("s");
      return grpc::Status::OK;
    });
  }

  grpc::Status DeleteSession(ServerContext* context, const v1::DeleteSessionRequest* request,
                             v1::DeleteSessionResponse* response) override {
    return state_.Unary("DeleteSession", context, *request, response,
                        [&](const auto&) { return grpc::Status::OK; });
  }

  // One triangle, whatever the outlines.
  grpc::Status MeshOutline(ServerContext* context, const v1::MeshOutlineRequest* request,
                           v1::MeshOutlineResponse* response) override {
    return state_.Unary("MeshOutline", context, *request, response, [&](const auto&) {
      for (const double x : {0, 0, 1, 0, 0, 1}) response->mutable_mesh()->add_vertices(x);
      for (const std::uint32_t v : {0u, 1u, 2u}) response->mutable_mesh()->add_triangles(v);
      response->set_piece_count(1);
      return grpc::Status::OK;
    });
  }

  grpc::Status RegisterMesh(ServerContext* context, const v1::RegisterMeshRequest* request,
                            v1::RegisterMeshResponse* response) override {
    return state_.Unary("RegisterMesh", context, *request, response, [&](const auto& session) {
      const std::string id = request->mesh_id().empty() ? "mesh" : request->mesh_id();
      state_.Describe(id, request->mesh(), response->mutable_mesh());
      const std::lock_guard lock(state_.mutex);
      state_.meshes[session + id] = request->mesh();
      return grpc::Status::OK;
    });
  }

  grpc::Status GetMesh(ServerContext* context, const v1::GetMeshRequest* request,
                       v1::GetMeshResponse* response) override {
    return state_.Unary("GetMesh", context, *request, response, [&](const auto& session) {
      const std::lock_guard lock(state_.mutex);
      const auto found = state_.meshes.find(session + request->mesh_id());
      if (found == state_.meshes.end()) return Missing("mesh");
      state_.Describe(request->mesh_id(), found->second, response->mutable_mesh());
      return grpc::Status::OK;
    });
  }

  grpc::Status DeleteMesh(ServerContext* context, const v1::DeleteMeshRequest* request,
                          v1::DeleteMeshResponse* response) override {
    return state_.Unary("DeleteMesh", context, *request, response, [&](const auto& session) {
      const std::lock_guard lock(state_.mutex);
      return state_.meshes.erase(session + request->mesh_id()) > 0 ? grpc::Status::OK
                                                                   : Missing("mesh");
    });
  }

  grpc::Status CompileHandles(ServerContext* context, const v1::CompileHandlesRequest* request,
                              v1::CompileHandlesResponse* response) override {
    return state_.Unary("CompileHandles", context, *request, response, [&](const auto& session) {
      State::Set set{request->mesh_id(), {}, 1};
      for (const v1::Handle& handle : request->handles()) set.handles.push_back(handle.handle_id());
      state_.Describe(request->handle_set_id(), set, response->mutable_handle_set());
      const std::lock_guard lock(state_.mutex);
      state_.sets[session + request->handle_set_id()] = set;
      return grpc::Status::OK;
    });
  }

  grpc::Status EditHandles(ServerContext* context, const v1::EditHandlesRequest* request,
                           v1::EditHandlesResponse* response) override {
    return state_.Unary("EditHandles", context, *request, response, [&](const auto& session) {
      const std::lock_guard lock(state_.mutex);
      const auto found = state_.sets.find(session + request->handle_set_id());
      if (found == state_.sets.end()) return Missing("handle set");
      Edit(request->remove(), request->add(), found->second);
      state_.Describe(request->handle_set_id(), found->second, response->mutable_handle_set());
      return grpc::Status::OK;
    });
  }

  grpc::Status GetHandleSet(ServerContext* context, const v1::GetHandleSetRequest* request,
                            v1::GetHandleSetResponse* response) override {
    return state_.Unary("GetHandleSet", context, *request, response, [&](const auto& session) {
      const auto found = state_.Find(session, request->handle_set_id());
      if (!found) return Missing("handle set");
      state_.Describe(request->handle_set_id(), found->first, response->mutable_handle_set());
      return grpc::Status::OK;
    });
  }

  grpc::Status DeleteHandleSet(ServerContext* context, const v1::DeleteHandleSetRequest* request,
                               v1::DeleteHandleSetResponse* response) override {
    return state_.Unary("DeleteHandleSet", context, *request, response, [&](const auto& session) {
      const std::lock_guard lock(state_.mutex);
      return state_.sets.erase(session + request->handle_set_id()) > 0 ? grpc::Status::OK
                                                                       : Missing("handle set");
    });
  }

  grpc::Status Deform(ServerContext* context, const v1::DeformRequest* request,
                      v1::DeformResponse* response) override {
    return state_.Unary("Deform", context, *request, response, [&](const auto& session) {
      const auto found = state_.Find(session, request->handle_set_id());
      if (!found) return Missing("handle set");
      *response->mutable_shape() = state_.Rest(found->second, found->first, request->options(),
                                               request->pick_points_size() / 2);
      state_.Changed(*response->mutable_shape());
      return grpc::Status::OK;
    });
  }

  grpc::Status DeformTrack(ServerContext* context, const v1::DeformTrackRequest* request,
                           grpc::ServerWriter<v1::DeformTrackResponse>* writer) override {
    if (const auto end = state_.Begin("DeformTrack", *context)) return *end;
    const auto found = state_.Find(request->session_id() + "/", request->handle_set_id());
    if (!found) return Missing("handle set");
    auto frames = static_cast<std::uint64_t>(request->frames_size());
    {
      const std::lock_guard lock(state_.mutex);
      frames = state_.frames.value_or(frames);
    }
    for (std::uint64_t frame = 0; frame < frames; ++frame) {
      v1::Shape shape = state_.Rest(found->second, found->first, request->options(), 0);
      shape.set_sequence(frame);
      if (!writer->Write(state_.WithShape<v1::DeformTrackResponse>(std::move(shape)))) break;
    }
    return grpc::Status::OK;
  }

  grpc::Status StreamDeform(ServerContext* context,
                            grpc::ServerReaderWriter<v1::StreamDeformResponse,
                                                     v1::StreamDeformRequest>* stream) override {
    using Response = v1::StreamDeformResponse;
    if (!state_.IsHushed("StreamDeform")) {
      if (const auto end = state_.Begin("StreamDeform", *context)) return *end;
    }
    std::optional<std::pair<State::Set, v1::PlanarMesh>> found;
    v1::OpenStream open;
    for (v1::StreamDeformRequest request; stream->Read(&request);) {
      if (state_.IsHushed("StreamDeform")) continue;
      Response response;
      std::uint64_t sequence = 0;
      int picks = 0;
      if (request.has_ping()) {
        response.mutable_pong()->set_nonce(request.ping().nonce());
        state_.Changed(response);
        stream->Write(response);
        continue;
      }
      if (request.has_open()) {
        open = request.open();
        found = state_.Find(open.session_id() + "/", open.handle_set_id());
        if (!found) return Missing("handle set");
        state_.Describe(open.handle_set_id(), found->first,
                        response.mutable_opened()->mutable_handle_set());
        state_.Changed(response);
        stream->Write(response);
        continue;
      }
      if (!found) return {grpc::FAILED_PRECONDITION, "The first message must be open."};
      if (request.has_edit()) {
        Edit(request.edit().remove(), request.edit().add(), found->first);
        sequence = request.edit().sequence();
      } else {
        sequence = request.update().sequence();
        picks = request.update().pick_points_size() / 2;
      }
      {
        const std::lock_guard lock(state_.mutex);
        if (state_.only_pings) continue;
      }
      v1::Shape shape = state_.Rest(found->second, found->first, open.options(), picks);
      shape.set_sequence(sequence);
      stream->Write(state_.WithShape<Response>(std::move(shape)));
    }
    return grpc::Status::OK;
  }

 private:
  template <class Ids, class Handles>
  static void Edit(const Ids& remove, const Handles& add, State::Set& set) {
    for (const std::string& id : remove) std::erase(set.handles, id);
    for (const v1::Handle& handle : add) set.handles.push_back(handle.handle_id());
    ++set.revision;
  }

  State& state_;
};

}  // namespace

std::unique_ptr<grpc::Service> FakeServer::State::MakeDeformation(State& state) {
  return std::make_unique<FakeDeformation>(state);
}

}  // namespace arap::testing
