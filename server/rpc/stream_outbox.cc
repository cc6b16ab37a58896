#include "server/rpc/stream_outbox.h"

#include <utility>

#include "server/rpc/status_map.h"

namespace arap::rpc {

void StreamOutbox::Push(Message message) { answers_.push_back({std::move(message), false}); }

void StreamOutbox::PushUpdate(Message message, bool latest) {
  if (latest && replaceable()) {
    const std::uint64_t skipped = answers_.front().message.shape().replaced() + 1;
    message.mutable_shape()->set_replaced(message.shape().replaced() + skipped);
    answers_.clear();
  }
  answers_.push_back({std::move(message), true});
}

void StreamOutbox::PushError(std::uint64_t sequence, const Fault& fault) {
  Message message;
  message.mutable_error()->set_sequence(sequence);
  *message.mutable_error()->mutable_status() = ToRpcStatus(fault);
  Push(std::move(message));
}

bool StreamOutbox::Pop(Message* out) {
  if (pong_) {
    out->mutable_pong()->set_nonce(*std::exchange(pong_, std::nullopt));
    return true;
  }
  if (answers_.empty()) return false;
  *out = std::move(answers_.front().message);
  answers_.pop_front();
  return true;
}

void StreamOutbox::Clear() {
  answers_.clear();
  pong_.reset();
}

}  // namespace arap::rpc
