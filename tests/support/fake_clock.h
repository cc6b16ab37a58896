// FakeClock: a clock that stands still until a test moves it.
#pragma once

#include <atomic>
#include <chrono>

#include "server/runtime/clock.h"

namespace arap::runtime {

// Thread-safe. Both clocks start at an arbitrary fixed time and advance together; the time of day
// can be set.
class FakeClock final : public Clock {
 public:
  Wall WallNow() const override {
    return Wall(std::chrono::seconds(1'700'000'000)) + passed() +
           std::chrono::milliseconds(set_ms_.load());
  }
  Steady SteadyNow() const override { return Steady(std::chrono::seconds(1'000)) + passed(); }

  void Advance(std::chrono::milliseconds step) { passed_ms_ += step.count(); }
  void SetBy(std::chrono::milliseconds step) { set_ms_ += step.count(); }

 private:
  std::chrono::milliseconds passed() const { return std::chrono::milliseconds(passed_ms_.load()); }

  std::atomic<std::chrono::milliseconds::rep> passed_ms_{0};
  std::atomic<std::chrono::milliseconds::rep> set_ms_{0};
};

}  // namespace arap::runtime
