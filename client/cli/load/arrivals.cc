#include "client/cli/load/arrivals.h"

#include <cmath>
#include <utility>

#include "client/cli/load/draw.h"

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

}  // namespace arap::cli
