#include "client/src/stream_call.h"

#include <thread>
#include <utility>

namespace arap::client::internal {

void StreamCall::Leave() {
  constexpr std::chrono::milliseconds kMoment{200};
  bool left = false;
  {
    const MutexLock lock(&mutex_);
    if (!done_) context_.TryCancel();
    if (!reading_) EndReading();
    const auto end = std::chrono::steady_clock::now() + kMoment;
    while (!done_ && !changed_.WaitUntil(&mutex_, end)) {
    }
    left = left_ = !done_;
  }
  if (!left) delete this;
}

void StreamCall::Cancel() {
  const MutexLock lock(&mutex_);
  cancelled_ = true;
  context_.TryCancel();
  changed_.SignalAll();
}

// The hold is what allows reads and writes to be started from outside.
void StreamCall::EndReading() {
  if (std::exchange(over_, true)) return;
  RemoveHold();
  changed_.SignalAll();
}

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

bool StreamCall::Read(Response* response) {
  const MutexLock lock(&mutex_);
  if (!over_ && !reading_ && !got_) {
    reading_ = true;
    StartRead(&incoming_);
  }
  while (!got_ && !cancelled_ && !(over_ && done_)) changed_.Wait(&mutex_);
  if (!std::exchange(got_, false)) {
    end_ = done_ ? status_ : grpc::Status(grpc::CANCELLED, "The call was cancelled.");
    return false;
  }
  response->Swap(&incoming_);
  return true;
}

void StreamCall::OnReadDone(bool ok) {
  const MutexLock lock(&mutex_);
  reading_ = false;
  got_ = ok;
  if (!ok) EndReading();
  changed_.SignalAll();
}

void StreamCall::OnWriteDone(bool ok) {
  const MutexLock lock(&mutex_);
  writing_ = false;
  broken_ = !ok;
  unsent_.pop_front();
  WriteNext();
  changed_.SignalAll();
}

void StreamCall::OnDone(const grpc::Status& status) {
  const MutexLock lock(&mutex_);
  status_ = status;
  done_ = true;
  // Under the lock: the object may go as soon as it is let go of.
  changed_.SignalAll();
  // The channel goes with it, which must not happen on a thread of the channel's.
  if (left_) std::thread([this] { DeleteLeft(); }).detach();
}

void StreamCall::DeleteLeft() {
  // Not before OnDone has let go of the lock.
  { const MutexLock lock(&mutex_); }
  delete this;
}

}  // namespace arap::client::internal
