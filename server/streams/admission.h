// Admission: no stream makes the frames of the others late. LoadGuard knows the load of the server,
// StreamPace what one stream adds to it; a TokenBucket bounds how often it is updated.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <deque>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/runtime/clock.h"

namespace arap::app {

// Thread-safe. The load is the part of the interactive lane's time that frames take: measured over
// the last second or so, and for streams that are younger than that what they are expected to take.
class LoadGuard {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Seconds = std::chrono::duration<double>;

  // Nobody is refused with a `limit` of 0.
  LoadGuard(double limit, double workers) : limit_(limit), workers_(workers) {}

  // Asks for a stream that opens or wakes up (StreamPace) and whose frames are expected to keep
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

  void Measure(Seconds busy, Time now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const double limit_;
  const double workers_;
  mutable Mutex mutex_;
  std::deque<Sample> samples_ ABSL_GUARDED_BY(mutex_);
  std::deque<Newcomer> newcomers_ ABSL_GUARDED_BY(mutex_);
  double measured_ ABSL_GUARDED_BY(mutex_) = 0;
};

// What one frame takes of a worker on a mesh of `vertices`, with `refine` iterations, in seconds.
double FrameSeconds(std::size_t vertices, std::size_t refine);

// Not thread-safe. A stream is awake from an update on until none has come for LoadGuard::kWindow.
// Asleep it does not count in the load, so it has to be admitted again when it wakes up: it may
// have been opened when there was room, and wake up with a thousand others.
class StreamPace {
 public:
  using Time = LoadGuard::Time;

  // Of a stream that opens now.
  StreamPace(double frame_seconds, Time now)
      : frame_seconds_(frame_seconds), began_(now), last_(now) {}

  bool Asleep(Time now) const { return now - last_ >= LoadGuard::kWindow; }

  // The part of a worker's time that its frames are expected to take: as when it was last awake,
  // and before its first update those of a hand that moves as fast as a screen.
  double Share() const {
    constexpr double kUsualFps = 60;
    if (updates_ == 0) return std::min(kUsualFps * frame_seconds_, 1.0);
    const LoadGuard::Seconds awake =
        std::max<LoadGuard::Seconds>(last_ - began_, LoadGuard::kWindow);
    return std::min(static_cast<double>(updates_) * frame_seconds_ / awake.count(), 1.0);
  }

  void Update(Time now) {
    if (Asleep(now)) {
      began_ = now;
      updates_ = 0;
    }
    last_ = now;
    ++updates_;
  }

 private:
  double frame_seconds_;
  Time began_;  // of being awake
  Time last_;   // update, or the opening
  std::size_t updates_ = 0;
};

// So many a second, after a burst of as many. Not thread-safe.
class TokenBucket {
 public:
  // A rate of 0 or less grants everything.
  TokenBucket(double rate, runtime::Clock::Steady now)
      : rate_(rate), tokens_(std::max(rate, 1.0)), last_(now) {}

  bool Take(runtime::Clock::Steady now) {
    if (rate_ <= 0) return true;
    tokens_ += rate_ * std::chrono::duration<double>(now - last_).count();
    tokens_ = std::min(tokens_, std::max(rate_, 1.0));
    last_ = now;
    if (tokens_ < 1) return false;
    --tokens_;
    return true;
  }

 private:
  double rate_;
  double tokens_;
  runtime::Clock::Steady last_;
};

}  // namespace arap::app
