// Durations of one thing done again and again.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include <time.h>

namespace arap::bench {

// Processor time of this thread: everybody here works on one thread, so on an idle machine it is
// the wall-clock time, and on a busy one long work does not look longer than short work because it
// was interrupted more often.
class Samples {
 public:
  // Calls `work` and keeps how long it took; what it returns is destroyed by the caller, untimed.
  template <class Work>
  auto Time(Work&& work) {
    const double begin = Now();
    if constexpr (std::is_void_v<decltype(work())>) {
      work();
      Keep(begin);
    } else {
      auto result = work();
      Keep(begin);
      return result;
    }
  }

  // Microseconds.
  double Least() const { return *std::min_element(micros_.begin(), micros_.end()); }
  double Median() const {
    auto sorted = micros_;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
  }

 private:
  static double Now() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_nsec) * 1e-3;
  }
  void Keep(double begin) { micros_.push_back(Now() - begin); }

  std::vector<double> micros_;
};

// Repeats a round of measurements at least `rounds` times and until `seconds` have passed, `most`
// at most. Everybody takes part in every round, so that noise hits all alike.
template <class Round>
void Repeat(int rounds, double seconds, int most, Round&& round) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  for (int i = 0; i < most && (i < rounds || std::chrono::steady_clock::now() < end); ++i) round();
}

}  // namespace arap::bench
