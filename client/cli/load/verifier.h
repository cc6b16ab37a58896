// Verifier: computes once more what a server has answered, and compares.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "arap/client/client.h"
#include "client/cli/load/scene.h"
#include "core/base/mutex.h"

namespace arap::cli {

// The core that computes is that of a private arapd on this machine, in double precision: arapctl links
// no solver, as nobody does who only has the client library. One thread, kMostWaiting answers in wait at
// most; what comes while they wait is not verified, so that verifying never holds up what is measured.
// Thread-safe.
class Verifier {
 public:
  static constexpr std::size_t kMostWaiting = 64;

  // Told whether an answer was right, or of a fault of the private server.
  using Told = std::function<void(const Result<bool>&)>;

  // Where the handles of the scene were sent.
  struct Pose {
    std::vector<Complex> targets;
    // With the further handle of the scene: where they were when it came, which is why it is where it is.
    std::optional<std::vector<Complex>> extra_since = {};
    DeformOptions deform = {};
  };

  // Registers the scene with `reference`, which has to outlive it.
  static Result<std::unique_ptr<Verifier>> Open(const client::Client& reference,
                                                const LoadScene& scene);
  // What waits is not verified any more.
  ~Verifier();
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  void AskShape(Pose pose, client::Shape shape, Told told);
  // The surface of the scene, laid flat by default.
  void AskFlat(std::vector<Complex> uv, Told told);
  // The mesh of the scene, so many times as large.
  void AskMesh(double scale, client::MeshInfo info, Told told);
  // Until nothing waits.
  void AwaitAnswers();

 private:
  struct Question {
    std::function<Result<bool>()> is_right;
    Told told;
  };

  Verifier(const client::Client& reference, client::Session session, std::string mesh_id,
           const LoadScene& scene);

  void Ask(Question question);
  void Run();
  Result<std::vector<Complex>> PositionsOf(const Pose& pose) const;
  Result<bool> IsShape(const Pose& pose, const client::Shape& shape) const;
  Result<bool> IsFlat(const std::vector<Complex>& uv);
  Result<bool> IsMesh(double scale, const client::MeshInfo& info) const;

  const client::Client& reference_;
  const client::Session session_;
  const std::string mesh_id_;  // of the scene
  const LoadScene& scene_;
  const double rounding_;                   // what machines may differ by
  std::optional<std::vector<Complex>> uv_;  // of the surface, once it was asked for; of the thread
  Mutex mutex_;
  CondVar changed_;
  std::deque<Question> waiting_ ABSL_GUARDED_BY(mutex_);  // the first one is being computed
  bool over_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace arap::cli
