#include "server/store/store_clock.h"

#include "core/base/try.h"

namespace arap::store {
namespace {

using runtime::Clock;
using std::chrono::milliseconds;

constexpr std::chrono::seconds kAskEvery{10};
// Clocks that are kept in step are moved by less.
constexpr std::chrono::seconds kJump{10};

Clock::Wall Origin(Clock::Wall wall, Clock::Steady steady) {
  return wall - std::chrono::duration_cast<Clock::Wall::duration>(steady.time_since_epoch());
}

}  // namespace

StoreClock::StoreClock(SpecStore& specs, const Clock& clock)
    : specs_(specs), clock_(clock), origin_(Origin(clock.WallNow(), clock.SteadyNow())) {}

Status StoreClock::Refresh() {
  {
    const MutexLock lock(&mutex_);
    if (asked_ && clock_.SteadyNow() - *asked_ < kAskEvery) return {};
  }
  const Clock::Steady before = clock_.SteadyNow();
  const auto time = specs_.Time();
  const Clock::Steady after = clock_.SteadyNow();
  const MutexLock lock(&mutex_);
  if (!time) return asked_ ? Status() : Fail(time.error());
  asked_ = after;
  ours_ = !time->has_value();
  if (!ours_) origin_ = Origin(**time, before + (after - before) / 2);
  return {};
}

Clock::Wall StoreClock::Now() const {
  const MutexLock lock(&mutex_);
  return origin_ +
         std::chrono::duration_cast<Clock::Wall::duration>(clock_.SteadyNow().time_since_epoch());
}

milliseconds StoreClock::Jump() const {
  const auto jump = std::chrono::duration_cast<milliseconds>(clock_.WallNow() - Now());
  const MutexLock lock(&mutex_);
  return ours_ && std::chrono::abs(jump) > kJump ? jump : milliseconds::zero();
}

void StoreClock::Adopt(milliseconds jump) {
  const MutexLock lock(&mutex_);
  origin_ += jump;
}

}  // namespace arap::store
