#include "client/src/leavable_call.h"

#include <vector>

namespace arap::client::internal {
namespace {

// Calls that were left and have ended since. They hold their channels, and a channel must not go on
// a thread of its own, where a call ends: so they wait here for somebody else's thread.
struct Ended {
  Mutex mutex;
  std::vector<LeavableCall*> calls ABSL_GUARDED_BY(mutex);
};

Ended& TheEnded() {
  // Without an end of its own: gRPC's threads may come late.
  static auto* const kEnded = new Ended;
  return *kEnded;
}

}  // namespace

void LeavableCall::Cancel() {
  const MutexLock lock(&mutex_);
  cancelled_ = true;
  context_.TryCancel();
  changed_.SignalAll();
}

void LeavableCall::Leave() {
  bool left = false;
  {
    const MutexLock lock(&mutex_);
    if (!done_) context_.TryCancel();
    LetGo();
    const auto end = std::chrono::steady_clock::now() + kMoment;
    while (!done_ && !changed_.WaitUntil(&mutex_, end)) {
    }
    left = left_ = !done_;
  }
  if (!left) delete this;
  DeleteLeft();
}

void LeavableCall::End(const grpc::Status& status) {
  const MutexLock lock(&mutex_);
  status_ = status;
  done_ = true;
  // Under the lock: the object may go as soon as it is let go of.
  changed_.SignalAll();
  if (!left_) return;
  const MutexLock ended(&TheEnded().mutex);
  TheEnded().calls.push_back(this);
}

void LeavableCall::DeleteLeft() {
  std::vector<LeavableCall*> calls;
  {
    const MutexLock ended(&TheEnded().mutex);
    calls.swap(TheEnded().calls);
  }
  for (LeavableCall* const call : calls) {
    // Not before End has let go of the lock.
    { const MutexLock lock(&call->mutex_); }
    delete call;
  }
}

}  // namespace arap::client::internal
