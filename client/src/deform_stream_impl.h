// What a DeformStream holds: the call of the moment, and what outlives it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "client/src/channel.h"
#include "client/src/convert.h"
#include "client/src/replay_log.h"
#include "client/src/stream_call.h"

namespace arap::client {

// The reader's thread opens calls, the first and those after a loss; senders push on the call of
// the moment; a thread of its own asks for signs of life.
class DeformStream::Impl {
 public:
  Impl(std::shared_ptr<internal::Channel> channel, const StreamOptions& options,
       const CallOptions& call, v1::OpenStream open);
  ~Impl();

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
    std::chrono::milliseconds pause;  // before trying again
    Clock::time_point opened = {};    // again, the last time
    std::uint64_t last_said = 0;      // the sequence
  };

  bool resumes() const { return options_.resume_within.count() > 0; }
  // A new call, opened by the server; its handle set. It is the call of the moment, but nothing is
  // pushed on it before open_. `lost` as EndOf.
  Result<HandleSetInfo> OpenCall(bool* lost);
  // The next message, with the silence watched. False when the call is over.
  bool Next(Call& call, v1::StreamDeformResponse* response);
  // How a call that is over has ended, and whether it was lost.
  Status EndOf(const Call& call, bool* lost);
  // The event of a message; nothing when it is not the user's.
  Result<std::optional<StreamEvent>> EventOf(const v1::StreamDeformResponse& response);
  std::optional<StreamEvent> TakePong();
  // Opens again after the loss that `fault` tells of, for as long as the options say. The event, or
  // the last fault.
  Result<StreamEvent> Resume(Fault fault);
  // Waits before the next attempt. The fault with which to give up: `last` or kCancelled.
  Status Pause(const Fault& last);
  void SayAgain();  // with mutex_ held
  void End(Status status);
  void Watch(const std::stop_token& stop);
  // With mutex_ held: asks now or, the user's, when the call is open; only asks.
  void PushPing(std::optional<std::uint64_t> nonce);
  void SendPing(std::uint64_t nonce);

  const StreamOptions options_;
  const std::optional<std::chrono::system_clock::time_point> deadline_;
  const v1::OpenStream open_message_;
  HandleSetInfo handle_set_;  // set by Open, then constant
  // The reader's own.
  std::shared_ptr<internal::Channel> channel_;
  std::optional<Trouble> trouble_;

  std::mutex mutex_;
  std::condition_variable_any changed_;
  // All below is guarded by mutex_.
  std::shared_ptr<Call> call_;
  bool open_ = false;  // call_ may be pushed on
  bool sending_closed_ = false;
  bool cancelled_ = false;
  std::optional<internal::ReplayLog> log_;          // when it resumes
  std::deque<std::optional<std::uint64_t>> pings_;  // without answer; our own have no nonce
  bool waiting_ = false;                            // somebody reads
  bool silent_ = false;                             // for so long that call_ was given up
  Clock::time_point heard_;                         // while waiting_, since when nothing was heard
  Clock::time_point asked_;                         // for a sign of life, or the opening
  std::optional<Status> end_;                       // how the stream ended

  std::jthread watch_;  // last: it uses all of the above
};

}  // namespace arap::client
