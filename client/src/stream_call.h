// StreamCall: one StreamDeform call, from its start to its end.
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include <grpcpp/grpcpp.h>

#include "client/src/channel.h"
#include "core/base/mutex.h"

namespace arap::client::internal {

// Thread-safe; one thread at a time may Read. Nothing is read ahead of Read, so that who does not
// read holds up the server and not this machine's memory.
class StreamCall final
    : public grpc::ClientBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse> {
 public:
  using Request = v1::StreamDeformRequest;
  using Response = v1::StreamDeformResponse;

  // Starts the call; `prepare` sets up its context. With the last pointer to it a call that has not
  // ended is cancelled. Its end is waited for for a moment only: gRPC does not end a call while its
  // connection is being written to, which takes for ever where the other end has stopped reading.
  template <class Prepare>
  static std::shared_ptr<StreamCall> Start(std::shared_ptr<Channel> channel,
                                           const Prepare& prepare) {
    auto* const call = new StreamCall(std::move(channel));
    std::shared_ptr<StreamCall> owner(call, [](StreamCall* gone) { gone->Leave(); });
    prepare(call->context_);
    call->channel_->deformation().async()->StreamDeform(&call->context_, call);
    call->AddHold();
    call->StartCall();
    return owner;
  }
  ~StreamCall() override = default;
  StreamCall(const StreamCall&) = delete;
  StreamCall& operator=(const StreamCall&) = delete;

  // Sends behind what was pushed before, without waiting. Harmless when the call is over.
  void Push(Request request);
  // The same for the end of sending.
  void PushEnd();
  // Waits until everything pushed is with the transport, which is HTTP/2's back-pressure. False
  // when the call is over.
  bool WaitSent();
  bool is_clear() const;  // whether it would answer true, and at once
  // Since when the transport has not taken the message that it has; nothing when it has none.
  std::optional<std::chrono::steady_clock::time_point> writing_since() const;

  // Waits for the next message. False when the call has ended or was cancelled: then status() tells
  // how.
  bool Read(Response* response);
  // After Read has said false.
  const grpc::Status& status() const { return end_; }

  void Cancel();

 private:
  explicit StreamCall(std::shared_ptr<Channel> channel) : channel_(std::move(channel)) {}
  void Leave();
  void DeleteLeft();
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  void WriteNext() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void EndReading() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::shared_ptr<Channel> channel_;
  grpc::ClientContext context_;
  mutable Mutex mutex_;
  CondVar changed_;
  // The first one is being written while writing_.
  std::deque<Request> unsent_ ABSL_GUARDED_BY(mutex_);
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  std::chrono::steady_clock::time_point writing_since_ ABSL_GUARDED_BY(mutex_);
  bool end_wanted_ ABSL_GUARDED_BY(mutex_) = false;  // of sending
  bool end_sent_ ABSL_GUARDED_BY(mutex_) = false;
  bool broken_ ABSL_GUARDED_BY(mutex_) = false;  // a write has failed
  Response incoming_ ABSL_GUARDED_BY(mutex_);    // gRPC's while reading_
  bool reading_ ABSL_GUARDED_BY(mutex_) = false;
  bool got_ ABSL_GUARDED_BY(mutex_) = false;        // incoming_ is to be taken
  bool over_ ABSL_GUARDED_BY(mutex_) = false;       // nothing may be started any more
  bool cancelled_ ABSL_GUARDED_BY(mutex_) = false;  // by us
  bool done_ ABSL_GUARDED_BY(mutex_) = false;
  bool left_ ABSL_GUARDED_BY(mutex_) = false;    // nobody has it any more
  grpc::Status status_ ABSL_GUARDED_BY(mutex_);  // set with done_
  grpc::Status end_;                             // the reader's
};

}  // namespace arap::client::internal
