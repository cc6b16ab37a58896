#include "client/src/awaited.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "client/src/answers.h"
#include "client/src/replay_log.h"

namespace arap::client::internal {

void AwaitedAnswers::Sent(const v1::StreamDeformRequest& request, Time now) {
  const std::uint64_t sequence = SequenceOf(request);
  const auto picks = static_cast<std::size_t>(request.update().pick_points_size() / 2);
  const bool measured = request.has_edit() || request.update().measure();
  awaited_.push_back({sequence, sequence, {picks, measured}, now});
  if (!every_ && awaited_.size() > kMostApart) Shorten();
}

void AwaitedAnswers::Restart(std::span<const v1::StreamDeformRequest> messages, Time now) {
  awaited_.clear();
  for (const v1::StreamDeformRequest& message : messages) Sent(message, now);
}

// The older half becomes a range.
void AwaitedAnswers::Shorten() {
  const auto end = awaited_.begin() + static_cast<std::ptrdiff_t>(awaited_.size() / 2);
  Awaited range = awaited_.front();
  range.asked = {std::nullopt, false};
  for (auto at = awaited_.begin(); at != end; ++at) {
    range.first = std::min(range.first, at->first);
    range.last = std::max(range.last, at->last);
  }
  awaited_.erase(awaited_.begin(), end);
  awaited_.push_front(range);
}

Result<AwaitedAnswers::Asked> AwaitedAnswers::Take(std::uint64_t sequence) {
  const auto is_it = [&](const Awaited& awaited) {
    return awaited.first <= sequence && sequence <= awaited.last;
  };
  const auto end = every_ && !awaited_.empty() ? std::next(awaited_.begin()) : awaited_.end();
  const auto found = std::find_if(awaited_.begin(), end, is_it);
  if (found == end) {
    return Fail(BadAnswer(
        fmt::format("The server answered the sequence {}, for which it was not asked.", sequence)));
  }
  Asked asked = found->asked;
  asked.measured |= std::any_of(awaited_.begin(), found,
                                [](const Awaited& replaced) { return replaced.asked.measured; });
  // More of a range may be answered yet.
  const bool single = found->first == found->last;
  awaited_.erase(awaited_.begin(), single ? std::next(found) : found);
  return asked;
}

std::optional<AwaitedAnswers::Time> AwaitedAnswers::oldest() const {
  if (awaited_.empty()) return std::nullopt;
  return awaited_.front().since;
}

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
