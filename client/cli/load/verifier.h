// Verifier: computes shapes that a server has answered once more, and compares.
#pragma once

#include <atomic>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "arap/client/client.h"
#include "client/cli/load/scene.h"
#include "core/base/mutex.h"

namespace arap::cli {

// The core that computes is that of a private arapd on this machine, in double precision: arapctl links
// none. One thread, kMostWaiting shapes in wait at most; what comes while they wait is not verified,
// so that verifying never holds up what is measured. Thread-safe.
class Verifier {
 public:
  static constexpr std::size_t kMostWaiting = 64;

  // A shape to verify: where its handles were sent, and what came.
  struct Question {
    std::vector<Complex> targets, positions;
    double position_error = 0;
    std::function<void(Result<bool>)> told;  // whether it is right; a fault of the private server
  };

  // Registers the scene with `reference`, which has to outlive it.
  static Result<std::unique_ptr<Verifier>> Open(const client::Client& reference,
                                                const LoadScene& scene,
                                                const DeformOptions& deform);
  // What waits is not verified any more.
  ~Verifier();
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  void Ask(Question question);
  // Until nothing waits.
  void AwaitAnswers();

 private:
  Verifier(client::Session session, const LoadScene& scene, const DeformOptions& deform);

  void Run();
  Result<bool> IsRight(const Question& question) const;

  const client::Session session_;
  const LoadScene& scene_;
  const client::ShapeOptions options_;
  const double rounding_;  // what machines may differ by
  Mutex mutex_;
  CondVar changed_;
  std::deque<Question> waiting_ ABSL_GUARDED_BY(mutex_);  // the first one is being computed
  bool over_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace arap::cli
