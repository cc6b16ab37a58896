#include "tests/fuzz/world.h"

#include <cstdlib>

#include <google/protobuf/stubs/logging.h>
#include <spdlog/spdlog.h>

#include "server/rpc/services.h"
#include "tests/fuzz/check.h"

namespace arap::fuzz {
namespace {

constexpr std::uint32_t kSquares = 3;

// So little that an input cannot make a call slow, and that the limits themselves are met.
Limits SmallLimits() {
  Limits limits;
  limits.max_sessions = 4;
  limits.max_meshes_per_session = 3;
  limits.max_handle_sets_per_session = 3;
  limits.max_vertices = 128;
  limits.max_triangles = 200;
  limits.max_handles = 12;
  limits.max_track_frames = 16;
  limits.max_refine = 6;
  limits.max_flatten_triangles = 150;
  limits.max_cached_surfaces = 2;
  limits.max_stream_fps = 1e9;
  limits.max_queued_jobs = 64;
  return limits;
}

store::Stores Memory() {
  auto stores = store::OpenStores({});
  Promise(stores.has_value(), "there is a store in memory");
  return *std::move(stores);
}

void MustSucceed(const Status& status) {
  Promise(status.has_value(), "the world can be made",
          status ? "" : status.error().message.c_str());
}

}  // namespace

v1::CreateSessionRequest SessionRequest() {
  v1::CreateSessionRequest request;
  request.set_session_id(kSession);
  return request;
}

v1::RegisterMeshRequest MeshRequest() {
  v1::RegisterMeshRequest request;
  request.set_session_id(kSession);
  request.set_mesh_id(kMesh);
  request.mutable_repair()->set_weld(true);
  request.mutable_repair()->set_stitch(true);
  v1::PlanarMesh& mesh = *request.mutable_mesh();
  for (std::uint32_t y = 0; y <= kSquares; ++y) {
    for (std::uint32_t x = 0; x <= kSquares; ++x) {
      mesh.add_vertices(x);
      mesh.add_vertices(y);
      if (x == kSquares || y == kSquares) continue;
      const std::uint32_t corner = y * (kSquares + 1) + x;
      const std::uint32_t above = corner + kSquares + 1;
      for (const std::uint32_t vertex : {corner, corner + 1, above + 1, corner, above + 1, above}) {
        mesh.add_triangles(vertex);
      }
    }
  }
  return request;
}

v1::CompileHandlesRequest SetRequest() {
  v1::CompileHandlesRequest request;
  request.set_session_id(kSession);
  request.set_mesh_id(kMesh);
  request.set_handle_set_id(kSet);
  v1::Handle* handle = request.add_handles();
  handle->set_handle_id("a");
  handle->set_vertex(0);
  handle = request.add_handles();
  handle->set_handle_id("b");
  handle->set_vertex(kSquares);
  handle->set_hard(true);
  handle = request.add_handles();
  handle->set_handle_id("c");
  handle->set_oriented(true);
  handle->mutable_position()->set_x(1.25);
  handle->mutable_position()->set_y(2.5);
  return request;
}

World& World::Get() {
  static World& world = *new World;  // never destroyed: its lanes outlive main's statics
  return world;
}

World::World()
    : engine_(SmallLimits(), {1, 1, 1}, clock_, Memory()),
      services_(rpc::MakeServices(engine_, identity_, true)) {
  spdlog::set_level(spdlog::level::off);
  google::protobuf::SetLogHandler(nullptr);
  Make();
}

void World::Serve() {
  if (server_) return;
  grpc::ServerBuilder builder;
  for (const rpc::NamedService& service : services_) {
    builder.RegisterService(service.service.get());
  }
  server_ = builder.BuildAndStart();
  Promise(server_ != nullptr, "there is a server without sockets");
  const auto channel = server_->InProcessChannel({});
  deformation_ = v1::DeformationService::NewStub(channel);
  flattening_ = v1::FlatteningService::NewStub(channel);
  // A call has ended for its client before its reactor has written the log's line. The loggers are
  // static and go after main, before which this waits for the last line.
  std::atexit([] {
    grpc::Server& server = *Get().server_;
    server.Shutdown();
    server.Wait();
  });
}

v1::DeformationService::Stub& World::deformation() {
  Serve();
  return *deformation_;
}

v1::FlatteningService::Stub& World::flattening() {
  Serve();
  return *flattening_;
}

void World::Make() {
  v1::CreateSessionResponse session;
  MustSucceed(rpc::CreateSession(engine_, SessionRequest(), call(), &session));
  v1::RegisterMeshResponse mesh;
  MustSucceed(rpc::RegisterMesh(engine_, MeshRequest(), call(), &mesh));
  v1::CompileHandlesResponse set;
  MustSucceed(rpc::CompileHandles(engine_, SetRequest(), call(), &set));
  const auto found = engine_.sessions.Use(call().caller.owner, kSession);
  Promise(found.has_value(), "what was made is there");
  made_ = (*found)->record();
}

void World::Reset() {
  v1::ListSessionsResponse all;
  MustSucceed(rpc::ListSessions(engine_, {}, call(), &all));
  bool there = false;
  for (const v1::Session& session : all.sessions()) {
    if (session.session_id() == kSession) {
      const auto found = engine_.sessions.Use(call().caller.owner, kSession);
      there = found && (*found)->record() == made_;
      if (there) continue;
    }
    v1::DeleteSessionRequest request;
    request.set_session_id(session.session_id());
    v1::DeleteSessionResponse response;
    MustSucceed(rpc::DeleteSession(engine_, request, call(), &response));
  }
  if (!there) Make();
}

}  // namespace arap::fuzz
