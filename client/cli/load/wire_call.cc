#include "client/cli/load/wire_call.h"

namespace arap::cli {

void Gate::Enter() {
  const MutexLock lock(&mutex_);
  ++inside_;
}

void Gate::Leave() {
  const MutexLock lock(&mutex_);
  --inside_;
  changed_.SignalAll();
}

void Gate::AwaitEmpty() {
  const MutexLock lock(&mutex_);
  while (inside_ > 0) changed_.Wait(&mutex_);
}

bool Gate::AwaitFewer(std::size_t fewer, std::chrono::steady_clock::time_point until) {
  const MutexLock lock(&mutex_);
  while (inside_ >= fewer) {
    if (changed_.WaitUntil(&mutex_, until)) return inside_ < fewer;
  }
  return true;
}

void Bell::Ring() {
  const MutexLock lock(&mutex_);
  rung_ = true;
  changed_.SignalAll();
}

void Bell::AwaitUntil(std::chrono::steady_clock::time_point until) {
  const MutexLock lock(&mutex_);
  while (!rung_ && !changed_.WaitUntil(&mutex_, until)) {
  }
  rung_ = false;
}

void WireCall::OnReadDone(bool ok) {
  if (ok) {
    owner_.OnMessage(incoming_);
    StartRead(&incoming_);
    return;
  }
  owner_.OnReadEnd();
  RemoveHold();
}

void WireCall::OnWriteDone(bool ok) { owner_.OnWritten(ok); }

void WireCall::OnDone(const grpc::Status& status) {
  Gate& gate = gate_;
  owner_.OnOver(status);
  delete this;
  gate.Leave();
}

}  // namespace arap::cli
