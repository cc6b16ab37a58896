// Calls that are over for us when we have waited long enough, whatever gRPC says: what they have in
// common, a call with one answer, and one whose answers are read one after the other.
//
// gRPC does not end a call while its connection is being written to, which takes for ever where the
// other end has stopped reading: neither a deadline nor a cancellation helps then. Such a call is
// left. It stays in memory until its connection ends and another call of the process begins.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <utility>

#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>
#include <grpcpp/support/status.h>

#include "core/base/mutex.h"

namespace arap::client::internal {

// Thread-safe.
class LeavableCall {
 public:
  virtual ~LeavableCall() = default;
  LeavableCall(const LeavableCall&) = delete;
  LeavableCall& operator=(const LeavableCall&) = delete;

  // To be set up before the call starts.
  grpc::ClientContext& context() { return context_; }
  void Cancel();

  // What a call is held by: with the last pointer to it, it is left.
  struct Leaver {
    void operator()(LeavableCall* call) const { call->Leave(); }
  };

 protected:
  // How long the end of a call is waited for that should have ended.
  static constexpr std::chrono::milliseconds kMoment{200};

  LeavableCall() = default;

  // Allows gRPC to end the call as far as that is ours.
  virtual void LetGo() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {}
  // The last that a reactor does.
  void End(const grpc::Status& status);

  grpc::ClientContext context_;
  mutable Mutex mutex_;
  CondVar changed_;
  bool cancelled_ ABSL_GUARDED_BY(mutex_) = false;  // by us
  bool done_ ABSL_GUARDED_BY(mutex_) = false;
  grpc::Status status_ ABSL_GUARDED_BY(mutex_);  // set with done_

 private:
  void Leave();
  static void DeleteLeft();

  bool left_ ABSL_GUARDED_BY(mutex_) = false;  // nobody has it any more
};

template <class Call>
using Leaving = std::unique_ptr<Call, LeavableCall::Leaver>;

// One request, one answer.
template <class Response>
class UnaryCall final : public LeavableCall, public grpc::ClientUnaryReactor {
 public:
  static Leaving<UnaryCall> Make() { return Leaving<UnaryCall>(new UnaryCall); }

  // gRPC's until the call has ended.
  Response& response() { return response_; }

  // Waits for the end of the call, which has been started: a moment longer than until the deadline
  // or the stop, and not at all for one that gRPC does not end.
  grpc::Status Wait(const std::optional<std::chrono::system_clock::time_point>& deadline,
                    const std::stop_token& stop);

 private:
  UnaryCall() = default;
  void OnDone(const grpc::Status& status) override { End(status); }

  Response response_;
};

// The answers of a call, one after the other. Reactor is gRPC's, of a call with one request or with
// many. Nothing is read ahead of Read, so that who does not read holds up the server and not this
// machine's memory. One thread at a time may Read.
template <class Reactor, class Response>
class ReadingCall : public LeavableCall, public Reactor {
 public:
  using Clock = std::chrono::steady_clock;

  // To be called when the call has been set up.
  void Start() {
    // The hold is what allows reads and writes to be started from outside.
    this->AddHold();
    this->StartCall();
  }

  // Waits for the next answer, until `end` at most. False when the call has ended, was cancelled or
  // is late: then status() tells how.
  bool Read(Response* response, std::optional<Clock::time_point> end = {});
  // After Read has said false.
  const grpc::Status& status() const { return end_; }
  bool is_late() const { return late_; }

 protected:
  ReadingCall() = default;
  void OnReadDone(bool ok) override;
  void OnDone(const grpc::Status& status) override { End(status); }

  void LetGo() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) override {
    if (!reading_) EndReading();
  }
  void EndReading() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  bool over_ ABSL_GUARDED_BY(mutex_) = false;  // nothing may be started any more

 private:
  Response incoming_ ABSL_GUARDED_BY(mutex_);  // gRPC's while reading_
  bool reading_ ABSL_GUARDED_BY(mutex_) = false;
  bool got_ ABSL_GUARDED_BY(mutex_) = false;  // incoming_ is to be taken
  grpc::Status end_;                          // the reader's
  bool late_ = false;                         // likewise
};

// One request, answers one after the other.
template <class Response>
class PiecesCall final : public ReadingCall<grpc::ClientReadReactor<Response>, Response> {
 public:
  static Leaving<PiecesCall> Make() { return Leaving<PiecesCall>(new PiecesCall); }

 private:
  PiecesCall() = default;
};

template <class Response>
grpc::Status UnaryCall<Response>::Wait(
    const std::optional<std::chrono::system_clock::time_point>& deadline,
    const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  const std::stop_callback cancel(stop, [this] { Cancel(); });
  std::optional<Clock::time_point> end;
  if (deadline) end = Clock::now() + (*deadline - std::chrono::system_clock::now()) + kMoment;
  const MutexLock lock(&mutex_);
  bool leaving = false;
  while (!done_) {
    if (cancelled_ && !std::exchange(leaving, true)) {
      const auto moment = Clock::now() + kMoment;
      if (!end || moment < *end) end = moment;
    }
    if (!end) {
      changed_.Wait(&mutex_);
    } else if (changed_.WaitUntil(&mutex_, *end) && !done_ && Clock::now() >= *end) {
      return cancelled_ ? grpc::Status(grpc::CANCELLED, "The call was cancelled.")
                        : grpc::Status(grpc::DEADLINE_EXCEEDED, "Deadline Exceeded");
    }
  }
  return status_;
}

template <class Reactor, class Response>
bool ReadingCall<Reactor, Response>::Read(Response* response,
                                          std::optional<Clock::time_point> end) {
  const MutexLock lock(&mutex_);
  if (!over_ && !reading_ && !got_) {
    reading_ = true;
    this->StartRead(&incoming_);
  }
  while (!got_ && !cancelled_ && !(over_ && done_)) {
    if (!end) {
      changed_.Wait(&mutex_);
    } else if (changed_.WaitUntil(&mutex_, *end) && Clock::now() >= *end) {
      break;
    }
  }
  if (!std::exchange(got_, false)) {
    late_ = !cancelled_ && !(over_ && done_);
    end_ = late_   ? grpc::Status(grpc::DEADLINE_EXCEEDED, "Deadline Exceeded")
           : done_ ? status_
                   : grpc::Status(grpc::CANCELLED, "The call was cancelled.");
    return false;
  }
  response->Swap(&incoming_);
  return true;
}

template <class Reactor, class Response>
void ReadingCall<Reactor, Response>::OnReadDone(bool ok) {
  const MutexLock lock(&mutex_);
  reading_ = false;
  got_ = ok;
  if (!ok) EndReading();
  changed_.SignalAll();
}

template <class Reactor, class Response>
void ReadingCall<Reactor, Response>::EndReading() {
  if (std::exchange(over_, true)) return;
  this->RemoveHold();
  changed_.SignalAll();
}

}  // namespace arap::client::internal
