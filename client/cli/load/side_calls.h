// SideCalls: what a mix has beside the stream: baking, flattening and registering, as calls of a
// session that wait for nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>

#include <grpcpp/client_context.h>

#include "arap/base/result.h"
#include "arap/v1/deformation_service.pb.h"
#include "arap/v1/flattening_service.pb.h"
#include "client/cli/load/load_session.h"
#include "client/cli/load/results.h"
#include "client/cli/load/scene.h"
#include "client/cli/load/tally.h"
#include "client/cli/load/verifier.h"
#include "client/cli/load/wire_call.h"

namespace arap::cli {

// Thread-safe. A call holds its request and its answer; the request of a flattening is made once.
class SideCalls {
 public:
  // When the answer came, and what it was.
  using Done = std::function<void(Moment, const Result<ServerTimes>&)>;

  // How many frames are baked at once.
  static constexpr std::size_t kBakedFrames = 10;

  // All have to outlive the last call in the gate.
  SideCalls(const LoadScene& scene, std::uint64_t seed, Gate& gate);

  // Answers are verified with this from now on, where Start asks for it; it has to outlive the last call.
  void VerifyWith(Verifier& verifier) { verifier_ = &verifier; }

  // Makes the call once, within kWorkLimit, and checks its answer; `done` is told on a thread of gRPC.
  // `verified`, where there is one, is told whether a good answer is right; of a bake one frame is.
  // `number` makes what is baked and registered unlike what other calls have: a mesh that the server
  // has already would cost it nothing. A mesh is deleted again when it is registered, without counting.
  void Start(Operation operation, const LoadSession& session, std::uint64_t number, Done done,
             Verifier::Told verified = {});
  // Ends those that are under way.
  void CancelAll();

 private:
  class Bake;

  void Enter(grpc::ClientContext& context);
  // Then the call may go, and last of all it leaves the gate.
  void Leave(grpc::ClientContext& context);

  void StartFlatten(const LoadSession& session, Done done, Verifier::Told verified);
  void StartRegister(const LoadSession& session, std::uint64_t number, Done done,
                     Verifier::Told verified);
  void Forget(const LoadSession& session, const std::string& mesh_id);

  const LoadScene& scene_;
  const std::uint64_t seed_;
  Gate& gate_;
  Verifier* verifier_ = nullptr;
  Mutex mutex_;
  std::set<grpc::ClientContext*> under_way_ ABSL_GUARDED_BY(mutex_);
  v1::FlattenRequest flatten_;
  v1::RegisterMeshRequest register_;
};

}  // namespace arap::cli
