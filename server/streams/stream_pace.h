// StreamPace: how busy a stream is, for LoadGuard to decide on.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

#include "server/streams/load_guard.h"

namespace arap::app {

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

}  // namespace arap::app
