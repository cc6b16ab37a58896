// World: the server's engine with little room, one session in it, and no sockets.
#pragma once

#include <memory>
#include <vector>

#include <arap/v1/deformation_service.grpc.pb.h>
#include <arap/v1/flattening_service.grpc.pb.h>
#include <grpcpp/grpcpp.h>

#include "server/engine.h"
#include "server/rpc/caller_of.h"
#include "server/rpc/services.h"
#include "server/rpc/unary.h"
#include "server/runtime/clock.h"

namespace arap::fuzz {

// Session "s" with a grid of 3 × 3 squares as "m" and the set "h" on it: handles "a" at a vertex,
// "b" hard at another, "c" oriented in a triangle.
inline constexpr const char* kSession = "s";
inline constexpr const char* kMesh = "m";
inline constexpr const char* kSet = "h";

// The request that makes each of them.
v1::CreateSessionRequest SessionRequest();
v1::RegisterMeshRequest MeshRequest();
v1::CompileHandlesRequest SetRequest();

class World {
 public:
  // One for the process, as making it takes a thousand times as long as a call.
  static World& Get();

  app::Engine& engine() { return engine_; }
  rpc::Call call() const { return {}; }
  // Over a channel within the process.
  v1::DeformationService::Stub& deformation();
  v1::FlatteningService::Stub& flattening();

  // As it was before any call: other sessions gone, and this one made anew if it has changed.
  void Reset();

 private:
  World();
  void Make();
  // Serves within the process, if that is not so yet.
  void Serve();

  runtime::SystemClock clock_;
  rpc::Identity identity_;
  app::Engine engine_;
  std::vector<rpc::NamedService> services_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::DeformationService::Stub> deformation_;
  std::unique_ptr<v1::FlatteningService::Stub> flattening_;
  app::Session::Record made_;
};

}  // namespace arap::fuzz
