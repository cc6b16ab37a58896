// Blocker: a job that keeps one thread of a pool busy.
#pragma once

#include <chrono>
#include <future>
#include <string>

#include <gtest/gtest.h>

#include "server/runtime/worker_pool.h"

namespace arap::runtime {

inline constexpr std::chrono::seconds kPatience{60};
inline constexpr auto kReady = std::future_status::ready;

// Keeps one worker busy until opened.
class Blocker {
 public:
  explicit Blocker(WorkerPool& pool, const std::string& owner = {}) {
    auto started = started_.get_future();
    const auto job = [this, open = open_.get_future().share()] {
      started_.set_value();
      EXPECT_EQ(open.wait_for(kPatience), std::future_status::ready) << "nobody opens it";
    };
    EXPECT_TRUE(pool.TryPost(job, {owner}));
    EXPECT_EQ(started.wait_for(kPatience), std::future_status::ready) << "no worker is free";
  }
  void Open() { open_.set_value(); }

 private:
  std::promise<void> started_;
  std::promise<void> open_;
};

}  // namespace arap::runtime
