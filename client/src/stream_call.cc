#include "client/src/stream_call.h"

#include <utility>

namespace arap::client::internal {

StreamCall::~StreamCall() {
  std::unique_lock lock(mutex_);
  if (!done_) context_.TryCancel();
  if (!reading_) EndReading();
  changed_.wait(lock, [this] { return done_; });
}

// The hold is what allows reads and writes to be started from outside.
void StreamCall::EndReading() {
  if (std::exchange(over_, true)) return;
  RemoveHold();
  changed_.notify_all();
}

void StreamCall::Push(Request request) {
  const std::lock_guard lock(mutex_);
  if (over_ || broken_) return;
  unsent_.push_back(std::move(request));
  WriteNext();
}

void StreamCall::PushEnd() {
  const std::lock_guard lock(mutex_);
  end_wanted_ = true;
  WriteNext();
}

void StreamCall::WriteNext() {
  if (over_ || broken_ || writing_) return;
  if (!unsent_.empty()) {
    writing_ = true;
    StartWrite(&unsent_.front());
  } else if (end_wanted_ && !std::exchange(end_sent_, true)) {
    StartWritesDone();
  }
}

bool StreamCall::WaitSent() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return over_ || broken_ || unsent_.empty(); });
  return !over_ && !broken_;
}

bool StreamCall::is_clear() const {
  const std::lock_guard lock(mutex_);
  return !over_ && !broken_ && unsent_.empty();
}

bool StreamCall::Read(Response* response) {
  std::unique_lock lock(mutex_);
  if (!over_ && !reading_ && !got_) {
    reading_ = true;
    StartRead(&incoming_);
  }
  changed_.wait(lock, [this] { return got_ || (over_ && done_); });
  if (!std::exchange(got_, false)) return false;
  response->Swap(&incoming_);
  return true;
}

void StreamCall::OnReadDone(bool ok) {
  const std::lock_guard lock(mutex_);
  reading_ = false;
  got_ = ok;
  if (!ok) EndReading();
  changed_.notify_all();
}

void StreamCall::OnWriteDone(bool ok) {
  const std::lock_guard lock(mutex_);
  writing_ = false;
  broken_ = !ok;
  unsent_.pop_front();
  WriteNext();
  changed_.notify_all();
}

void StreamCall::OnDone(const grpc::Status& status) {
  const std::lock_guard lock(mutex_);
  status_ = status;
  done_ = true;
  // Under the lock: the object may go as soon as it is let go of.
  changed_.notify_all();
}

}  // namespace arap::client::internal
