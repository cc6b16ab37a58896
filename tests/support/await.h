// Await: waiting for what another thread brings about and nobody announces.
#pragma once

#include <chrono>
#include <thread>

#include <gtest/gtest.h>

namespace arap::testing {

inline constexpr std::chrono::minutes kLongest{1};

// Looks every millisecond until `condition` holds. After a minute fails with `what`, which should
// have happened at once: Await("a stream is open", [&] { return streams.count() > 0; }).
template <class Condition>
::testing::AssertionResult Await(const char* what, const Condition& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kLongest;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return ::testing::AssertionFailure() << "waited for a minute and yet not: " << what;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return ::testing::AssertionSuccess();
}

}  // namespace arap::testing
