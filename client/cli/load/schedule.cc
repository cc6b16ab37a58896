#include "client/cli/load/schedule.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/cli/load/chance.h"

namespace arap::cli {

Arrivals::Arrivals(std::shared_ptr<const RateProfile> profile, const ArrivalShare& share)
    : profile_(std::move(profile)), share_(share) {
  Find();
}

void Arrivals::Advance() {
  ++number_;
  Find();
}

void Arrivals::Find() {
  const auto streams = static_cast<double>(share_.streams);
  double count = 0;
  if (share_.poisson) {
    drawn_ -= std::log1p(-DrawPart(share_.seed, Draw::kArrival, share_.stream, number_));
    count = drawn_ * streams;
  } else {
    const std::size_t first = share_.alone ? 0 : share_.stream;
    count = static_cast<double>(number_) * streams + static_cast<double>(first);
  }
  const std::optional<double> when = profile_->When(count);
  next_ = when ? std::optional(FromSeconds(*when)) : std::nullopt;
}

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
