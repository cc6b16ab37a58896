// Waits of tests: each has a bound and says what it waited for.
#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <future>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <poll.h>

namespace arap::testing {

// What is waited for should happen at once; a busy machine and a sanitizer take longer.
inline constexpr std::chrono::minutes kLongest{1};

// Looks every millisecond until `condition` holds, or fails with `what` after kLongest:
// EXPECT_TRUE(Await("a stream is open", [&] { return streams.count() > 0; })).
inline ::testing::AssertionResult Await(const std::string& what,
                                        const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kLongest;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return ::testing::AssertionFailure() << "waited for a minute and yet not: " << what;
    }
    poll(nullptr, 0, 1);
  }
  return ::testing::AssertionSuccess();
}

// What a thread answers. A thread that is stuck cannot be joined, so the program ends with `what`.
template <class T>
T Answer(std::future<T>& future, const std::string& what) {
  if (future.wait_for(kLongest) != std::future_status::ready) {
    std::fprintf(stderr, "waited in vain for %s\n", what.c_str());
    std::abort();
  }
  return future.get();
}

// A thread of a test, joined within kLongest by Join() or by its end: BoundedThread
// writer("the writer", [&] { … }).
class BoundedThread {
 public:
  template <class Work>
  BoundedThread(std::string what, Work work) : what_(std::move(what)) {
    std::packaged_task<void()> task(std::move(work));
    done_ = task.get_future();
    thread_ = std::thread(std::move(task));
  }
  BoundedThread(BoundedThread&&) = default;
  BoundedThread& operator=(BoundedThread&&) = delete;
  ~BoundedThread() { Join(); }

  void Join() {
    if (!thread_.joinable()) return;
    Answer(done_, what_);
    thread_.join();
  }

 private:
  std::string what_;
  std::future<void> done_;
  std::thread thread_;
};

}  // namespace arap::testing
