#include "client/cli/load/verifier.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/cli/load/load_session.h"
#include "core/base/try.h"

namespace arap::cli {
namespace {

// Of the size of the mesh: what the same computation may differ by on another processor.
constexpr double kRounding = 1e-7;

}  // namespace

Result<std::unique_ptr<Verifier>> Verifier::Open(const client::Client& reference,
                                                 const LoadScene& scene,
                                                 const DeformOptions& deform) {
  TRY(client::Session session, reference.CreateSession());
  TRY(const client::Registration registered, session.RegisterMesh(scene.mesh, {}));
  CHECK_OK(session.CompileHandles(kLoadSet, registered.mesh.id, scene.handles));
  return std::unique_ptr<Verifier>(new Verifier(std::move(session), scene, deform));
}

Verifier::Verifier(client::Session session, const LoadScene& scene, const DeformOptions& deform)
    : session_(std::move(session)),
      scene_(scene),
      options_{.deform = deform, .float64 = true},
      rounding_(kRounding * 10 * scene.reach),
      thread_([this] { Run(); }) {}

Verifier::~Verifier() {
  {
    const MutexLock lock(&mutex_);
    over_ = true;
    changed_.SignalAll();
  }
  thread_.join();
}

void Verifier::Ask(Question question) {
  const MutexLock lock(&mutex_);
  if (waiting_.size() >= kMostWaiting) return;
  waiting_.push_back(std::move(question));
  changed_.SignalAll();
}

void Verifier::AwaitAnswers() {
  const MutexLock lock(&mutex_);
  while (!waiting_.empty()) changed_.Wait(&mutex_);
}

void Verifier::Run() {
  for (;;) {
    const Question* question = nullptr;
    {
      const MutexLock lock(&mutex_);
      while (!over_ && waiting_.empty()) changed_.Wait(&mutex_);
      if (over_) return;
      question = &waiting_.front();  // stays where it is while others come behind it
    }
    question->told(IsRight(*question));
    const MutexLock lock(&mutex_);
    waiting_.pop_front();
    changed_.SignalAll();
  }
}

Result<bool> Verifier::IsRight(const Question& question) const {
  std::vector<HandleTarget> targets;
  for (std::size_t k = 0; k < question.targets.size(); ++k) {
    targets.push_back({scene_.handles[k].id, {question.targets[k]}});
  }
  TRY(const client::Shape shape, session_.Deform(kLoadSet, targets, options_));
  const double most = question.position_error + rounding_;
  return std::equal(shape.positions.begin(), shape.positions.end(), question.positions.begin(),
                    question.positions.end(), [&](Complex a, Complex b) {
                      return std::abs(a.real() - b.real()) <= most &&
                             std::abs(a.imag() - b.imag()) <= most;
                    });
}

}  // namespace arap::cli
