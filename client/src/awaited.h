// What a stream waits for. AwaitedAnswers: which updates and edits have no answer yet, by which an
// answer is known for one that was asked for. SignsOfLife: when to ask the server for a sign of
// life, which answers belong to whom, and when it has been silent for too long.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "arap/base/result.h"

namespace arap::v1 {
class StreamDeformRequest;
}

namespace arap::client::internal {

// Not thread-safe. Answers come in the order of what they answer; with `every` nothing is left out,
// else newer updates may take the place of older ones. Memory: some 40 bytes for each, about
// kMostApart of them unless `every`; older ones are then known as a range only.
class AwaitedAnswers {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::size_t kMostApart = 4096;

  explicit AwaitedAnswers(bool every) : every_(every) {}

  // An update or an edit goes out.
  void Sent(const v1::StreamDeformRequest& request, Time now);
  // A new call begins, on which these are said first.
  void Restart(std::span<const v1::StreamDeformRequest> messages, Time now);

  struct Asked {
    std::optional<std::size_t> picks;  // nothing when that is not known any more
    // For an edit, or an update that asks for it; or in whose place the answer comes, such a one.
    bool measured = false;
  };
  // The answer to this sequence came: what was asked of it. kInternal when none of that sequence is
  // due.
  Result<Asked> Take(std::uint64_t sequence);

  // Since when the oldest waits.
  std::optional<Time> oldest() const;

 private:
  struct Awaited {
    std::uint64_t first = 0, last = 0;  // the same for a single one
    Asked asked;
    Time since;
  };

  void Shorten();

  const bool every_;
  std::deque<Awaited> awaited_;
};

// Of the user's pings and the stream's own. The server answers each, in order. Not thread-safe; the
// time is the caller's to tell.
class SignsOfLife {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // Asks after so much silence, and gives up after so much.
  SignsOfLife(std::chrono::milliseconds heartbeat, std::chrono::milliseconds silence)
      : heartbeat_(heartbeat), silence_(silence) {}

  // A new call begins. Our own questions were lost with the call before.
  void Restart(Time now);
  // Somebody begins to wait for a message, or has got one, or knows that there is none.
  void SetWaiting(bool waiting, Time now);

  // A question goes out: the user's with its nonce, or our own. While the call is not open yet,
  // only our own go out; the user's are kept and come behind them.
  void Ask(std::optional<std::uint64_t> nonce, bool open, Time now);
  // Whether an answer with this nonce is due. Our own questions have the nonce 0.
  bool IsDueAnswer(std::uint64_t nonce) const {
    return !asked_.empty() && asked_.front().value_or(0) == nonce;
  }
  // An answer came: the nonce of the user's question; nothing for one of our own.
  std::optional<std::uint64_t> Answered();
  // The user's questions without answer, in order.
  std::vector<std::uint64_t> Unanswered() const;

  // Whether the server counts as gone.
  bool IsSilent(Time now) const { return waiting_ && now - heard_ >= silence_; }
  // Whether to ask. `clear`: the transport takes more.
  bool IsDue(bool clear, Time now) const;

 private:
  const std::chrono::milliseconds heartbeat_, silence_;
  std::deque<std::optional<std::uint64_t>> asked_;  // without answer; our own have no nonce
  bool waiting_ = false;                            // somebody reads
  Time heard_;                                      // while waiting_, since when nothing was heard
  Time last_asked_;                                 // or when the call was begun
};

}  // namespace arap::client::internal
