#include "client/cli/load/pacer.h"

#include <chrono>
#include <utility>

#include <sys/prctl.h>

namespace arap::cli {

Moment Now() { return std::chrono::steady_clock::now().time_since_epoch(); }

Pacer::Pacer(std::size_t threads, std::function<void(std::size_t)> wake) : wake_(std::move(wake)) {
  for (std::size_t i = 0; i < threads; ++i) lanes_.push_back(std::make_unique<Lane>());
  for (const auto& lane : lanes_) {
    lane->thread = std::thread([this, &lane = *lane] { Run(lane); });
  }
}

Pacer::~Pacer() {
  for (const auto& lane : lanes_) {
    const MutexLock lock(&lane->mutex);
    lane->over = true;
    lane->changed.Signal();
  }
  for (const auto& lane : lanes_) lane->thread.join();
}

void Pacer::At(std::size_t sleeper, Moment when) {
  Lane& lane = *lanes_[sleeper % lanes_.size()];
  const MutexLock lock(&lane.mutex);
  const bool sooner = lane.appointments.empty() || when < lane.appointments.top().when;
  lane.appointments.push({when, sleeper});
  if (sooner) lane.changed.Signal();
}

void Pacer::Run(Lane& lane) {
  prctl(PR_SET_TIMERSLACK, 1UL);
  for (;;) {
    std::size_t sleeper = 0;
    {
      const MutexLock lock(&lane.mutex);
      for (;;) {
        if (lane.over) return;
        if (lane.appointments.empty()) {
          lane.changed.Wait(&lane.mutex);
          continue;
        }
        const Moment when = lane.appointments.top().when;
        if (when <= Now()) break;
        lane.changed.WaitUntil(&lane.mutex, std::chrono::steady_clock::time_point(when));
      }
      sleeper = lane.appointments.top().sleeper;
      lane.appointments.pop();
    }
    wake_(sleeper);
  }
}

}  // namespace arap::cli
