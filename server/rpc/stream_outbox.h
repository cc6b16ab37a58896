// StreamOutbox: the answers of one stream that wait for the write before them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include <arap/v1/deformation_service.pb.h>

#include "arap/base/fault.h"

namespace arap::rpc {

// Not thread-safe. Bounded by its user: work starts only when there is room, and reading pauses
// while a pong waits, so that a client that does not read costs one waiting answer and one waiting
// pong.
class StreamOutbox {
 public:
  using Message = v1::StreamDeformResponse;

  // No answer waits. (A pong may.)
  bool empty() const { return answers_.empty(); }
  bool pong_waits() const { return pong_.has_value(); }
  // Whether the only answer that waits is the shape of an update, which a newer one may replace.
  bool replaceable() const { return answers_.size() == 1 && answers_.front().replaceable; }

  // Adds an answer behind the others.
  void Push(Message message);
  // Adds the shape of an update. With `latest` it takes the place of a replaceable one and counts
  // it, and what that one had replaced, in its own `replaced`.
  void PushUpdate(Message message, bool latest);
  void PushError(std::uint64_t sequence, const Fault& fault);
  void SetPong(std::uint64_t nonce) { pong_ = nonce; }

  // Moves the next message to `out`, a pong before the answers. False when there is none.
  bool Pop(Message* out);
  void Clear();

 private:
  struct Answer {
    Message message;
    bool replaceable;
  };
  std::deque<Answer> answers_;
  std::optional<std::uint64_t> pong_;
};

}  // namespace arap::rpc
