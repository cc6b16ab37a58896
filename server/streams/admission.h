// Admission: no stream makes the frames of the others late. Admission knows which streams are awake
// and what each is entitled to, StreamPace what one stream asks for.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <string>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/runtime/clock.h"

namespace arap::app {

// What every stream that is let in is promised: so many frames a second, or as many as it asks for
// when that is less. Whoever asks for more gets it while there is time, and has no claim to it.
inline constexpr double kFloorFps = 30;

// Frames that are expected to take longer go to the lane of jobs and are promised nothing.
inline constexpr double kLongFrameSeconds = 0.033;

// A stream is awake from an update on until none has come for so long.
inline constexpr std::chrono::milliseconds kAwake{1'500};

// Thread-safe. Streams that are awake are entitled to the time that their frames take at kFloorFps
// at most, whatever they ask for: greed is no load. Those that sleep or have only been opened are
// entitled to nothing. A newcomer is refused only when
//   - all together would be entitled to more than there is, and
//   - its owner's would be entitled to more than an equal part, and it is not its owner's only one.
// So no owner keeps another one out. A gateway and its users count as one owner.
class Admission {
 public:
  using Time = runtime::Clock::Steady;
  // A stream, by an address of its own.
  using Stream = const void*;

  // There is the part `limit` of the time of `workers`. Nobody is refused with a limit of 0.
  Admission(double limit, double workers) : capacity_(limit * workers) {}

  // Whether a stream of `owner` that is entitled to `share` of a worker would be let in if it woke
  // up now. kLimitExceeded with "max_stream_load", and what would fit.
  Status MayOpen(const std::string& owner, double share, Time now);
  // The same for one that wakes up: it counts from now on.
  Status WakeUp(Stream stream, const std::string& owner, double share, Time now);
  // It is still awake. To be told every kAwake / 3 or so.
  void StaysAwake(Stream stream, double share, Time now);
  void Leave(Stream stream);

  // What those that are awake are entitled to, in workers.
  double Entitled(Time now);

 private:
  struct Awake {
    std::string owner;
    double share = 0;
    Time last;
  };

  void DropSleepersLocked(Time now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  Status FitsLocked(const std::string& owner, double share) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const double capacity_;
  Mutex mutex_;
  std::map<Stream, Awake> awake_ ABSL_GUARDED_BY(mutex_);
};

// Not thread-safe. How often a stream is updated and what its frames take.
class StreamPace {
 public:
  using Time = Admission::Time;

  // Of a stream that opens, with frames that are expected to take so long.
  explicit StreamPace(double frame_seconds) : frame_seconds_(frame_seconds) {}

  bool Asleep(Time now) const { return updates_ == 0 || now - last_ >= kAwake; }
  double frame_seconds() const { return frame_seconds_; }
  bool LongFrames() const { return frame_seconds_ > kLongFrameSeconds; }

  // The part of a worker's time that it is entitled to when it is awake: at the rate of when it was
  // last awake, and before its first update at kFloorFps.
  double Share() const {
    if (LongFrames()) return 0;
    return std::min(std::min(rate_, kFloorFps) * frame_seconds_, 1.0);
  }

  void Update(Time now) {
    if (Asleep(now)) {
      began_ = now;
      updates_ = 0;
    }
    last_ = now;
    ++updates_;
    const double awake = std::chrono::duration<double>(now - began_).count();
    // A few of them say nothing.
    if (awake >= kShortest) rate_ = static_cast<double>(updates_) / awake;
  }

  // A frame took so long.
  void Took(double seconds) {
    constexpr double kWeight = 0.2;
    frame_seconds_ += kWeight * (seconds - frame_seconds_);
  }

 private:
  static constexpr double kShortest = 0.5;

  double frame_seconds_;
  double rate_ = kFloorFps;
  Time began_{};  // of being awake
  Time last_{};   // update
  std::size_t updates_ = 0;
};

}  // namespace arap::app
