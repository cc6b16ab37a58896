#include "client/src/stream_call.h"

#include <utility>

namespace arap::client::internal {

void StreamCall::Push(Request request) {
  const MutexLock lock(&mutex_);
  if (over_ || broken_) return;
  unsent_.push_back(std::move(request));
  WriteNext();
}

void StreamCall::PushEnd() {
  const MutexLock lock(&mutex_);
  end_wanted_ = true;
  WriteNext();
}

void StreamCall::WriteNext() {
  if (over_ || broken_ || writing_) return;
  if (!unsent_.empty()) {
    writing_ = true;
    writing_since_ = std::chrono::steady_clock::now();
    StartWrite(&unsent_.front());
  } else if (end_wanted_ && !std::exchange(end_sent_, true)) {
    StartWritesDone();
  }
}

bool StreamCall::WaitSent() {
  const MutexLock lock(&mutex_);
  while (!over_ && !broken_ && !cancelled_ && !unsent_.empty()) changed_.Wait(&mutex_);
  return !over_ && !broken_ && !cancelled_;
}

bool StreamCall::is_clear() const {
  const MutexLock lock(&mutex_);
  return !over_ && !broken_ && unsent_.empty();
}

std::optional<std::chrono::steady_clock::time_point> StreamCall::writing_since() const {
  const MutexLock lock(&mutex_);
  return writing_ ? std::optional(writing_since_) : std::nullopt;
}

void StreamCall::OnWriteDone(bool ok) {
  const MutexLock lock(&mutex_);
  writing_ = false;
  broken_ = !ok;
  unsent_.pop_front();
  WriteNext();
  changed_.SignalAll();
}

}  // namespace arap::client::internal
