#include "client/src/signs_of_life.h"

#include <algorithm>

namespace arap::client::internal {

void SignsOfLife::Restart(Time now) {
  std::erase(asked_, std::nullopt);
  last_asked_ = now;
}

void SignsOfLife::SetWaiting(bool waiting, Time now) {
  waiting_ = waiting;
  heard_ = now;
}

void SignsOfLife::Ask(std::optional<std::uint64_t> nonce, bool open, Time now) {
  asked_.insert(nonce || open ? asked_.end() : asked_.begin(), nonce);
  last_asked_ = now;
}

std::optional<std::uint64_t> SignsOfLife::Answered() {
  if (asked_.empty()) return std::nullopt;
  const std::optional<std::uint64_t> nonce = asked_.front();
  asked_.pop_front();
  return nonce;
}

std::vector<std::uint64_t> SignsOfLife::Unanswered() const {
  std::vector<std::uint64_t> nonces;
  for (const std::optional<std::uint64_t>& nonce : asked_) {
    if (nonce) nonces.push_back(*nonce);
  }
  return nonces;
}

bool SignsOfLife::IsDue(bool clear, Time now) const {
  const bool asking = std::any_of(asked_.begin(), asked_.end(), [](auto& nonce) { return !nonce; });
  // While nobody reads, answers are not seen: we go on asking as long as the server takes it.
  if (asking && (waiting_ || !clear)) return false;
  return now - (waiting_ ? heard_ : last_asked_) >= heartbeat_;
}

}  // namespace arap::client::internal
