// StreamCall: one StreamDeform call, from its start to its end.
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include <grpcpp/grpcpp.h>

#include "client/src/channel.h"
#include "client/src/leavable_call.h"
#include "core/base/mutex.h"

namespace arap::client::internal {

// Thread-safe; one thread at a time may Read.
class StreamCall final
    : public ReadingCall<grpc::ClientBidiReactor<v1::StreamDeformRequest, v1::StreamDeformResponse>,
                         v1::StreamDeformResponse> {
 public:
  using Request = v1::StreamDeformRequest;
  using Response = v1::StreamDeformResponse;

  // Starts the call; `prepare` sets up its context. With the last pointer to it a call that has not
  // ended is cancelled, and its end waited for for a moment only.
  template <class Prepare>
  static std::shared_ptr<StreamCall> Start(std::shared_ptr<Channel> channel,
                                           const Prepare& prepare) {
    const std::shared_ptr<StreamCall> call(new StreamCall(std::move(channel)), Leaver());
    prepare(call->context());
    call->channel_->deformation().async()->StreamDeform(&call->context(), call.get());
    call->ReadingCall::Start();
    return call;
  }
  ~StreamCall() override = default;

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

 private:
  explicit StreamCall(std::shared_ptr<Channel> channel) : channel_(std::move(channel)) {}
  void OnWriteDone(bool ok) override;

  void WriteNext() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::shared_ptr<Channel> channel_;
  // The first one is being written while writing_.
  std::deque<Request> unsent_ ABSL_GUARDED_BY(mutex_);
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  std::chrono::steady_clock::time_point writing_since_ ABSL_GUARDED_BY(mutex_);
  bool end_wanted_ ABSL_GUARDED_BY(mutex_) = false;  // of sending
  bool end_sent_ ABSL_GUARDED_BY(mutex_) = false;
  bool broken_ ABSL_GUARDED_BY(mutex_) = false;  // a write has failed
};

}  // namespace arap::client::internal
