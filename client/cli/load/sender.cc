#include "client/cli/load/sender.h"

#include <algorithm>

namespace arap::cli {

Moment Sender::Intended() const {
  if (closed_ || taken_ >= options_.most) return kNever;
  if (!arrivals_) return options_.begin;
  const std::optional<Moment> next = arrivals_->next();
  if (!next || options_.begin + *next >= options_.end) return kNever;
  return options_.begin + *next;
}

Moment Sender::NextDue() const { return on_their_way_ < options_.window ? Intended() : kNever; }

std::optional<Sender::Due> Sender::Take(Moment now) {
  const Moment due = NextDue();
  if (due > now) return std::nullopt;
  if (!arrivals_ && now >= options_.end) {
    closed_ = true;
    return std::nullopt;
  }
  ++on_their_way_;
  const Due taken{taken_++, arrivals_ ? due : now};
  if (arrivals_) arrivals_->Advance();
  return taken;
}

void Sender::Close(Moment now, const std::function<void(const Due&)>& unsent) {
  const Moment until = std::min(now, options_.end);
  for (Moment due = Intended(); arrivals_ && due < until; due = Intended()) {
    unsent({taken_++, due});
    arrivals_->Advance();
  }
  closed_ = true;
}

}  // namespace arap::cli
