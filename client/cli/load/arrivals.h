// Arrivals: when the messages of one stream are due, whatever becomes of those before them.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "client/cli/load/rate_profile.h"

namespace arap::cli {

// Times of a run, since an origin that everything in the process shares.
using Moment = std::chrono::nanoseconds;
constexpr Moment FromSeconds(double seconds) {
  return std::chrono::duration_cast<Moment>(std::chrono::duration<double>(seconds));
}
constexpr double SecondsOf(Moment moment) { return std::chrono::duration<double>(moment).count(); }
constexpr double MicrosOf(Moment moment) {
  return std::chrono::duration<double, std::micro>(moment).count();
}

// Which part of the messages is a stream's.
struct ArrivalShare {
  std::size_t stream = 0, streams = 1;
  // The gaps between messages of a stream are drawn, as those of many independent people are: as
  // long as the mean on average, exponentially distributed. Else all messages of all streams are
  // equally far apart, and streams take turns.
  bool poisson = false;
  std::uint64_t seed = 0;
  // The first one is due at once: of streams that have their times to themselves.
  bool alone = false;
};

// For one thread. The same shares give the same times.
class Arrivals {
 public:
  Arrivals(std::shared_ptr<const RateProfile> profile, const ArrivalShare& share);

  // When the next one is due, since the beginning of the profile; nothing at its end.
  std::optional<Moment> next() const { return next_; }
  // It is the turn of the one after it.
  void Advance();

 private:
  void Find();

  std::shared_ptr<const RateProfile> profile_;
  ArrivalShare share_;
  std::uint64_t number_ = 0;
  double drawn_ = 0;  // of Poisson arrivals: where the next one is among the stream's own
  std::optional<Moment> next_;
};

}  // namespace arap::cli
