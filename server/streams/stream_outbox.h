// StreamOutbox: the answers of one stream that wait for the write before them.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "arap/base/fault.h"

namespace arap::app {

// An answer as the wire has it, made by a job and written by the reactor. What is between them
// passes it on unread.
struct WireAnswer {
  WireAnswer() = default;
  WireAnswer(const WireAnswer&) = delete;
  WireAnswer& operator=(const WireAnswer&) = delete;
  virtual ~WireAnswer() = default;
};

struct StreamAnswer {
  enum class Kind { kOpened, kShape, kError, kPong };
  Kind kind = Kind::kOpened;
  std::uint64_t sequence = 0;           // kShape, kError: of the message that it answers
  std::uint64_t replaced = 0;           // kShape: updates that newer ones replaced
  std::unique_ptr<WireAnswer> message;  // kOpened, kShape
  std::optional<Fault> fault;           // kError
  std::uint64_t nonce = 0;              // kPong
};

// Not thread-safe. Bounded by its user: work starts only when there is room, and reading pauses
// while a pong waits, so that a client that does not read costs one waiting answer and one waiting
// pong.
class StreamOutbox {
 public:
  // No answer waits. (A pong may.)
  bool empty() const { return answers_.empty(); }
  bool pong_waits() const { return pong_.has_value(); }
  // Whether the only answer that waits is the shape of an update, which a newer one may replace.
  bool replaceable() const { return answers_.size() == 1 && answers_.front().replaceable; }

  // Adds an answer behind the others.
  void Push(StreamAnswer answer) { answers_.push_back({std::move(answer), false}); }

  // Adds the shape of an update. With `latest` it takes the place of a replaceable one and counts
  // it, and what that one had replaced, in its own `replaced`.
  void PushUpdate(StreamAnswer shape, bool latest) {
    if (latest && replaceable()) {
      shape.replaced += answers_.front().answer.replaced + 1;
      answers_.clear();
    }
    answers_.push_back({std::move(shape), true});
  }

  void SetPong(std::uint64_t nonce) { pong_ = nonce; }

  // The next message, a pong before the answers. Nothing when there is none.
  std::optional<StreamAnswer> Pop() {
    std::optional<StreamAnswer> next;
    if (pong_) {
      next.emplace().kind = StreamAnswer::Kind::kPong;
      next->nonce = *std::exchange(pong_, std::nullopt);
    } else if (!answers_.empty()) {
      next = std::move(answers_.front().answer);
      answers_.pop_front();
    }
    return next;
  }

  void Clear() {
    answers_.clear();
    pong_.reset();
  }

 private:
  struct Waiting {
    StreamAnswer answer;
    bool replaceable;
  };
  std::deque<Waiting> answers_;
  std::optional<std::uint64_t> pong_;
};

}  // namespace arap::app
