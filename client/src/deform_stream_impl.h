// DeformStream::Impl: the stream behind its public face.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <thread>

#include "arap/client/deform_stream.h"
#include "client/src/answers.h"
#include "client/src/awaited.h"
#include "client/src/calls.h"
#include "client/src/channel.h"
#include "client/src/replay_log.h"
#include "client/src/stream_call.h"
#include "core/base/mutex.h"

namespace arap::client {

// What a DeformStream holds: the call of the moment, and what outlives it. The reader's thread
// opens calls, the first and those after a loss; senders push on the call of the moment; a thread
// of its own asks for signs of life.
class DeformStream::Impl {
 public:
  Impl(std::shared_ptr<internal::Channel> channel, std::shared_ptr<internal::KnownSizes> sizes,
       const StreamOptions& options, const CallOptions& call, v1::OpenStream open);
  ~Impl() { Cancel(); }

  // Opens the first call. Once, first.
  Status Open();
  Status Send(v1::StreamDeformRequest request);
  Status Ping(std::uint64_t nonce);
  Status CloseSending();
  Result<std::optional<StreamEvent>> Read();
  void Cancel();

  const HandleSetInfo& handle_set() const { return handle_set_; }

 private:
  using Call = internal::StreamCall;
  using Clock = std::chrono::steady_clock;

  // From a loss until the server has answered what was said again.
  struct Trouble {
    Clock::time_point until;
    internal::Backoff backoff;
    Clock::time_point opened = {};  // again, the last time
    std::uint64_t last_said = 0;    // the sequence
  };

  bool resumes() const { return options_.resume_within.count() > 0; }
  // A new call, opened by the server; its handle set. It is the call of the moment, but nothing is
  // pushed on it before open_. `lost` as EndOf.
  Result<HandleSetInfo> OpenCall(bool* lost);
  // Which vertices the shapes of a new call are of: the same as those of the call before.
  Status TakeVertices(Result<std::vector<std::uint32_t>> answered);
  // The next message, with the silence watched. False when the call is over.
  bool Next(Call& call, v1::StreamDeformResponse* response);
  // How a call that is over has ended, and whether it was lost.
  Status EndOf(const Call& call, bool* lost);
  // The event of a message; nothing when it is not the user's.
  Result<std::optional<StreamEvent>> EventOf(const v1::StreamDeformResponse& response);
  Result<std::optional<StreamEvent>> ShapeOf(const v1::Shape& shape);
  // Notes the answer to a sequence. Whether there was one before.
  bool Known(std::uint64_t sequence, bool good) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The event of a pong; nothing when the question was our own. kInternal when there was none.
  Result<std::optional<StreamEvent>> TakePong(std::uint64_t nonce);
  // Opens again after the loss that `fault` tells of, for as long as the options say. The event, or
  // the last fault.
  Result<StreamEvent> Resume(Fault fault);
  // Waits before the next attempt. The fault with which to give up: `last` or kCancelled.
  Status Pause(const Fault& last);
  void SayAgain() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void End(Status status);
  // Asks for signs of life, and gives up a call on which nothing happens, until the stream ends.
  void Watch();
  // Why the call is not to be waited for any longer; nothing as long as it is.
  std::optional<Fault> Overdue(Clock::time_point now) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Asks now or, the user's, when the call is open; only asks.
  void PushPing(std::optional<std::uint64_t> nonce) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void SendPing(std::uint64_t nonce) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const StreamOptions options_;
  const std::optional<std::chrono::system_clock::time_point> deadline_;
  const internal::CallHeaders headers_;
  const v1::OpenStream open_message_;
  HandleSetInfo handle_set_;  // set by Open, then constant
  // The reader's own.
  std::shared_ptr<internal::Channel> channel_;
  const std::shared_ptr<internal::KnownSizes> sizes_;
  internal::ShapeQuestion asked_;  // its mesh once it is known
  std::uint32_t unmeasured_ = 0;   // shapes since the last that was measured, of this call
  std::optional<Trouble> trouble_;

  Mutex mutex_;
  CondVar changed_;
  std::shared_ptr<Call> call_ ABSL_GUARDED_BY(mutex_);
  bool open_ ABSL_GUARDED_BY(mutex_) = false;  // call_ may be pushed on
  bool sending_closed_ ABSL_GUARDED_BY(mutex_) = false;
  bool cancelled_ ABSL_GUARDED_BY(mutex_) = false;
  bool silent_ ABSL_GUARDED_BY(mutex_) = false;           // for so long that call_ was given up
  std::optional<Fault> overdue_ ABSL_GUARDED_BY(mutex_);  // why it was given up for good
  // Since when an opening or an event is waited for; nothing when nobody waits.
  std::optional<Clock::time_point> waiting_since_ ABSL_GUARDED_BY(mutex_);
  internal::AwaitedAnswers awaited_ ABSL_GUARDED_BY(mutex_);
  std::optional<internal::ReplayLog> log_ ABSL_GUARDED_BY(mutex_);  // when it resumes
  internal::SignsOfLife life_ ABSL_GUARDED_BY(mutex_);
  std::optional<Status> end_ ABSL_GUARDED_BY(mutex_);  // how the stream ended

  std::jthread watch_;  // last: it uses all of the above
};

}  // namespace arap::client
