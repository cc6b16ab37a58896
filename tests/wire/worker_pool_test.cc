// The worker pool: bounded, in order, nothing lost.
#include "server/runtime/worker_pool.h"

#include <atomic>
#include <future>
#include <vector>

#include <gtest/gtest.h>

namespace arap::runtime {
namespace {

// Keeps one worker busy until opened.
class Blocker {
 public:
  explicit Blocker(WorkerPool& pool) {
    auto started = started_.get_future();
    EXPECT_TRUE(pool.TryPost([this, open = open_.get_future().share()] {
      started_.set_value();
      open.wait();
    }));
    started.wait();
  }
  void Open() { open_.set_value(); }

 private:
  std::promise<void> started_;
  std::promise<void> open_;
};

TEST(WorkerPoolTest, RunsJobsInTheOrderOfPosting) {
  WorkerPool pool(1, 100);
  std::vector<int> order;
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(pool.TryPost([&order, i] { order.push_back(i); }));
  pool.Stop();
  ASSERT_EQ(order.size(), 50u);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(order[static_cast<std::size_t>(i)], i);
}

TEST(WorkerPoolTest, RefusesWhatDoesNotFit) {
  WorkerPool pool(1, 2);
  Blocker blocker(pool);
  std::atomic<int> runs{0};
  EXPECT_TRUE(pool.TryPost([&] { ++runs; }));
  EXPECT_TRUE(pool.TryPost([&] { ++runs; }));
  EXPECT_FALSE(pool.TryPost([&] { ++runs; }));
  EXPECT_EQ(pool.waiting(), 2u);
  EXPECT_TRUE(pool.Continue([&] { ++runs; })) << "continued work is not refused";
  blocker.Open();
  pool.Stop();
  EXPECT_EQ(runs, 3);
}

TEST(WorkerPoolTest, ThreadsWorkAtTheSameTime) {
  WorkerPool pool(2, 2);
  Blocker first(pool);
  Blocker second(pool);  // would wait for ever on a single thread
  first.Open();
  second.Open();
}

TEST(WorkerPoolTest, StopRunsWhatWaitsAndRefusesMore) {
  WorkerPool pool(1, 10);
  Blocker blocker(pool);
  std::atomic<int> runs{0};
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(pool.TryPost([&] { ++runs; }));
  blocker.Open();
  pool.Stop();
  EXPECT_EQ(runs, 5);
  EXPECT_FALSE(pool.TryPost([&] { ++runs; }));
  EXPECT_FALSE(pool.Continue([&] { ++runs; }));
  pool.Stop();
  EXPECT_EQ(runs, 5);
}

TEST(WorkerPoolTest, HasAtLeastOneThread) { EXPECT_EQ(WorkerPool(0, 1).threads(), 1u); }

}  // namespace
}  // namespace arap::runtime
