// Clock: where the server gets the time from, so that tests can move it. WallTimer: how long
// something waited or took.
#pragma once

#include <chrono>

namespace arap::runtime {

// Thread-safe.
class Clock {
 public:
  using Wall = std::chrono::system_clock::time_point;
  using Steady = std::chrono::steady_clock::time_point;

  virtual ~Clock() = default;
  // The time of day, for showing.
  virtual Wall WallNow() const = 0;
  // Never jumps; everything that expires is measured with it.
  virtual Steady SteadyNow() const = 0;
};

class SystemClock final : public Clock {
 public:
  Wall WallNow() const override { return std::chrono::system_clock::now(); }
  Steady SteadyNow() const override { return std::chrono::steady_clock::now(); }
};

// Of the steady clock, from its construction on; core/base/cpu_timer.h has the processor time of a
// thread.
class WallTimer {
 public:
  double Micros() const {
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start_)
        .count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace arap::runtime
