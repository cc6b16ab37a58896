// Eventually: a wait of tests that has a bound and says what it waited for.
#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <future>
#include <string>

#include <gtest/gtest.h>
#include <poll.h>

namespace arap::testing {

inline constexpr std::chrono::seconds kPatience{20};

// Asks until `condition` is true. EXPECT_TRUE(Eventually("the queue to be empty", [&] { … })).
inline ::testing::AssertionResult Eventually(const std::string& what,
                                             const std::function<bool()>& condition,
                                             std::chrono::milliseconds bound = kPatience) {
  const auto deadline = std::chrono::steady_clock::now() + bound;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return ::testing::AssertionFailure() << "waited " << bound.count() << " ms for " << what;
    }
    poll(nullptr, 0, 1);
  }
  return ::testing::AssertionSuccess();
}

// What a thread answers; a test whose thread is stuck ends here, since it could not be joined.
template <class T>
T Answer(std::future<T>& future, const char* what) {
  if (future.wait_for(kPatience) != std::future_status::ready) {
    std::fprintf(stderr, "waited in vain for %s\n", what);
    std::abort();
  }
  return future.get();
}

}  // namespace arap::testing
