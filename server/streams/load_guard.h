// LoadGuard: no stream is admitted that would make the frames of the others late.
#pragma once

#include <chrono>
#include <deque>
#include <mutex>

#include "arap/base/result.h"

namespace arap::app {

// Thread-safe. The load is the part of the interactive lane's time that frames take: measured over
// the last second or so, and for streams that are younger than that what they are expected to take.
class LoadGuard {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Seconds = std::chrono::duration<double>;

  // Nobody is refused with a `limit` of 0.
  LoadGuard(double limit, double workers) : limit_(limit), workers_(workers) {}

  // Asks for a stream that opens or wakes up (stream_pace.h) and whose frames are expected to keep
  // one worker busy for `share` of the time. `busy` is what all workers have worked since the
  // start. kLimitExceeded with "max_stream_load"; on an idle server everything is admitted, however
  // large.
  Status Admit(double share, Seconds busy, Time now);

  // Looks at the load. To be called every second or so: between two looks there is only an average.
  void Look(Seconds busy, Time now);

  // The measured part, 0 to 1.
  double Measured() const;

  // How long a new stream counts with what is expected of it, and how long is measured.
  static constexpr std::chrono::milliseconds kWindow{1'500};

 private:
  struct Sample {
    Time time;
    Seconds busy{};
  };
  struct Newcomer {
    Time time;
    double share = 0;
  };

  void MeasureLocked(Seconds busy, Time now);

  const double limit_;
  const double workers_;
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  std::deque<Sample> samples_;
  std::deque<Newcomer> newcomers_;
  double measured_ = 0;
};

}  // namespace arap::app
