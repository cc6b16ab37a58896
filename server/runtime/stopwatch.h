// Stopwatch: how long something waited or took, in microseconds of the steady clock.
#pragma once

#include <chrono>

namespace arap::runtime {

class Stopwatch {
 public:
  double Micros() const {
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start_)
        .count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace arap::runtime
