// The worker pool: bounded, in order, nothing lost.
#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <future>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/runtime/metrics.h"

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

TEST(WorkerPoolTest, UrgentJobsComeFirstAndFindRoom) {
  WorkerPool pool(1, 2);
  Blocker blocker(pool);
  std::string order;
  EXPECT_TRUE(pool.TryPost([&] { order += "a"; }));
  EXPECT_TRUE(pool.PostUrgent([&] { order += "1"; }));
  EXPECT_TRUE(pool.TryPost([&] { order += "b"; }));
  EXPECT_FALSE(pool.TryPost([] {}));
  EXPECT_TRUE(pool.PostUrgent([&] { order += "2"; }));
  EXPECT_EQ(pool.waiting(), 4u);
  EXPECT_GT(pool.stats().oldest_waiting.count(), 0);
  blocker.Open();
  pool.Stop();
  EXPECT_EQ(order, "12ab");
  EXPECT_FALSE(pool.PostUrgent([] {}));
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

TEST(WorkerPoolTest, TellsWhatItDoes) {
  Metrics metrics;
  WorkerPool pool({"lane", 1, 10, 0, &metrics});
  EXPECT_EQ(pool.name(), "lane");
  EXPECT_EQ(pool.stats().running, 0u);
  EXPECT_EQ(pool.stats().oldest_running.count(), 0);
  Blocker blocker(pool);
  EXPECT_TRUE(pool.TryPost([] {}));
  const PoolStats busy = pool.stats();
  EXPECT_EQ(busy.running, 1u);
  EXPECT_EQ(busy.waiting, 1u);
  EXPECT_EQ(busy.completed, 0u);
  EXPECT_GT(busy.oldest_running.count(), 0);
  EXPECT_GT(busy.oldest_waiting.count(), 0);
  EXPECT_GE(busy.busy, busy.oldest_running);
  EXPECT_GE(pool.stats().since_finish, busy.oldest_running) << "nothing has ended yet";
  blocker.Open();
  pool.Stop();
  const PoolStats done = pool.stats();
  EXPECT_EQ(done.running, 0u);
  EXPECT_EQ(done.completed, 2u);
  EXPECT_GT(done.busy.count(), 0);
  EXPECT_NE(metrics.Text().find("arapd_queue_seconds_count{lane=\"lane\"} 2\n"), std::string::npos);
}

TEST(WorkerPoolTest, ThreadsAreAsNiceAsAsked) {
  const int ours = getpriority(PRIO_PROCESS, 0);
  int theirs = 0;
  std::array<char, 16> name{};
  {
    WorkerPool pool({"jobs", 1, 1, std::min(ours + 3, 19), nullptr});
    EXPECT_TRUE(pool.TryPost([&] {
      theirs = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
      pthread_getname_np(pthread_self(), name.data(), name.size());
    }));
  }
  EXPECT_EQ(theirs, std::min(ours + 3, 19));
  EXPECT_STREQ(name.data(), "jobs");
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), ours);
}

TEST(WorkerPoolTest, HasAtLeastOneThread) { EXPECT_EQ(WorkerPool(0, 1).threads(), 1u); }

}  // namespace
}  // namespace arap::runtime
