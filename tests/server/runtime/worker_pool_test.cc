// The worker pool: bounded, in order, nothing lost.
#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/runtime/metrics.h"
#include "tests/server/runtime/blocker.h"
#include "tests/support/bounded.h"

namespace arap::runtime {
namespace {

using std::chrono::milliseconds;

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

TEST(WorkerPoolTest, OwnersTakeTurns) {
  WorkerPool pool(1, 4);
  Blocker blocker(pool);
  std::string order;
  const auto post = [&](const char* job, const char* owner, std::uint64_t flow = 0) {
    return pool.TryPost([&order, job] { order += job; }, {owner, flow, 1});
  };
  EXPECT_TRUE(post("1", "ann"));
  EXPECT_TRUE(post("2", "ann"));
  EXPECT_TRUE(post("3", "ann"));
  EXPECT_TRUE(post("4", "ann"));
  EXPECT_FALSE(post("5", "ann"));
  EXPECT_EQ(pool.OutlookOf("ann").place, 4u);
  EXPECT_GT(pool.OutlookOf("ann").wait, std::chrono::seconds(3));
  EXPECT_EQ(pool.OutlookOf("ben").place, 0u);
  EXPECT_TRUE(post("b", "ben")) << "there is room for another owner";
  EXPECT_TRUE(pool.Continue([&] { order += "s"; }, {"ann", 7, 1}));
  EXPECT_EQ(pool.waiting(), 6u);
  EXPECT_GT(pool.stats().oldest_waiting.count(), 0);
  blocker.Open();
  pool.Stop();
  EXPECT_EQ(order, "1bs234") << "ben's only call and ann's stream do not wait for all of ann's";
  EXPECT_FALSE(pool.Continue([] {}));
}

TEST(WorkerPoolTest, ShortJobsHaveAPlaceOfTheirOwn) {
  PoolOptions options{"jobs", 1, 10};
  options.short_seconds = 0.05;
  std::promise<void> open, done;  // both outlive the pool, which runs jobs until it is destroyed
  WorkerPool pool(options);
  EXPECT_EQ(pool.threads(), 2u);
  const auto wait = [&open] { EXPECT_EQ(open.get_future().wait_for(kPatience), kReady); };
  EXPECT_TRUE(pool.TryPost(wait, {"ann", 0, 60}));
  EXPECT_TRUE(pool.TryPost([] {}, {"ann", 0, 60})) << "waits";
  EXPECT_TRUE(pool.TryPost([&done] { done.set_value(); }, {"ann", 0, 0.01}));
  EXPECT_EQ(done.get_future().wait_for(kPatience), kReady) << "the short one waits for the long";
  open.set_value();
}

TEST(WorkerPoolTest, AShortJobDoesNotWaitForTheLongOneThatWasTakenBeforeIt) {
  PoolOptions options{"jobs", 1, 10};
  options.short_seconds = 0.05;
  WorkerPool pool(options);
  Blocker blocker(pool);
  std::promise<void> open;
  std::promise<void> done;
  const auto wait = [&open] { EXPECT_EQ(open.get_future().wait_for(kPatience), kReady); };
  EXPECT_TRUE(pool.TryPost(wait, {"ann", 0, 60}));
  EXPECT_TRUE(pool.TryPost([&done] { done.set_value(); }, {"ben", 0, 0.01}));
  blocker.Open();
  EXPECT_EQ(done.get_future().wait_for(kPatience), kReady) << "the short one waits for the long";
  open.set_value();
}

// Goes on, step by step, until it is told to end.
void Work(std::atomic<bool>& over) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!over && std::chrono::steady_clock::now() < end) GiveWay();
  EXPECT_TRUE(over) << "nobody ends it";
}

TEST(WorkerPoolTest, LongJobsTakeTurns) {
  PoolOptions options{"jobs", 1, 10};
  options.aside = 2;
  WorkerPool pool(options);
  EXPECT_EQ(pool.threads(), 1u);
  std::atomic<bool> over = false;
  std::atomic<int> at_once = 0;
  EXPECT_TRUE(pool.TryPost([&] { Work(over); }, {"ann", 0, 60}));
  for (const char* owner : {"ben", "cas", "ben"}) {
    std::promise<void> done;
    const auto job = [&] {
      EXPECT_EQ(++at_once, 1);
      EXPECT_EQ(pool.stats().running, 1u) << "the long one stands aside";
      --at_once;
      done.set_value();
    };
    EXPECT_TRUE(pool.TryPost(job, {owner, 0, 1}));
    EXPECT_EQ(done.get_future().wait_for(kPatience), kReady) << owner;
  }
  std::promise<void> done;
  EXPECT_TRUE(pool.TryPost([&done] { done.set_value(); }, {"ann", 0, 1}));
  EXPECT_EQ(done.get_future().wait_for(kPatience), kReady) << "a shorter one of the same owner";
  over = true;
  pool.Stop();
  EXPECT_EQ(pool.stats().completed, 5u);
}

TEST(WorkerPoolTest, WhatTurnsOutLongLeavesThePlaceOfTheShort) {
  PoolOptions options{"jobs", 1, 10};
  options.short_seconds = 0.05;
  options.aside = 2;
  WorkerPool pool(options);
  std::atomic<bool> over = false;
  EXPECT_TRUE(pool.TryPost([&] { Work(over); }, {"ann", 0, 60}));
  EXPECT_TRUE(pool.TryPost([&] { Work(over); }, {"ann", 0, 0.01}));
  for (int i = 0; i < 3; ++i) {
    std::promise<void> done;
    EXPECT_TRUE(pool.TryPost([&done] { done.set_value(); }, {"ann", 0, 0.01}));
    EXPECT_EQ(done.get_future().wait_for(kPatience), kReady) << i;
  }
  over = true;
}

TEST(WorkerPoolTest, StopWaitsForThoseAside) {
  std::atomic<int> ended = 0;
  {
    PoolOptions options{"jobs", 1, 10};
    options.aside = 4;
    WorkerPool pool(options);
    std::atomic<bool> over = false;
    for (const char* owner : {"ann", "ben", "cas"}) {
      EXPECT_TRUE(pool.TryPost(
          [&] {
            Work(over);
            ++ended;
          },
          {owner, 0, 60}));
    }
    EXPECT_TRUE(pool.TryPost([&over] { over = true; }, {"dan", 0, 1}));
    pool.Stop();
  }
  EXPECT_EQ(ended, 3);
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
  WorkerPool pool({"lane", 1, 10, &metrics});
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

// Jobs give way to frames inside the process; among the processes of the machine they are no less.
TEST(WorkerPoolTest, ThreadsHaveTheNameOfThePoolAndThePriorityOfTheProcess) {
  const int ours = getpriority(PRIO_PROCESS, 0);
  int theirs = ours + 1;
  std::array<char, 16> name{};
  WorkerPool frames(1, 1);
  {
    WorkerPool pool({"jobs", 1, 1, nullptr, &frames});
    EXPECT_TRUE(pool.TryPost([&] {
      theirs = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
      pthread_getname_np(pthread_self(), name.data(), name.size());
    }));
  }
  EXPECT_EQ(theirs, ours);
  EXPECT_STREQ(name.data(), "jobs");
}

TEST(WorkerPoolTest, TellsWhenAThreadIsFree) {
  WorkerPool pool(2, 2);
  EXPECT_TRUE(pool.AwaitFreeThread(milliseconds::zero()));
  Blocker first(pool);
  EXPECT_TRUE(pool.AwaitFreeThread(milliseconds::zero())) << "the second one";
  Blocker second(pool);
  EXPECT_FALSE(pool.AwaitFreeThread(milliseconds(1)));
  std::atomic<bool> opened{false};
  testing::BoundedThread waiting("the one that waits for a thread", [&] {
    EXPECT_TRUE(pool.AwaitFreeThread(kPatience)) << "no thread has become free";
    EXPECT_TRUE(opened);
  });
  opened = true;
  first.Open();
  waiting.Join();
  second.Open();
}

TEST(WorkerPoolTest, WhatWaitsIsNotPassedOver) {
  WorkerPool pool(1, 2);
  Blocker first(pool);
  std::promise<void> open;
  EXPECT_TRUE(pool.TryPost([&] { open.get_future().wait_for(kPatience); }));
  first.Open();
  EXPECT_FALSE(pool.AwaitFreeThread(milliseconds(1))) << "the second job waits or runs";
  open.set_value();
  EXPECT_TRUE(pool.AwaitFreeThread(kPatience));
}

TEST(WorkerPoolTest, LongJobsGiveWayWhileAllFramesAreBusyAndYetGetOn) {
  WorkerPool frames(1, 1);
  WorkerPool jobs({"jobs", 1, 4, nullptr, &frames});
  const auto run = [&jobs](WorkerPool::Job job) {
    std::promise<void> done;
    EXPECT_TRUE(jobs.TryPost([&] {
      job();
      done.set_value();
    }));
    EXPECT_EQ(done.get_future().wait_for(kPatience), std::future_status::ready) << "the job";
  };
  run(&GiveWay);
  EXPECT_EQ(jobs.stats().gave_way, 0u) << "nobody is in a hurry";
  Blocker frame(frames);
  run(&GiveWay);
  EXPECT_EQ(jobs.stats().gave_way, 1u) << "and it has ended, although the frame has not";
  frame.Open();
  frames.Stop();
  run(&GiveWay);
  EXPECT_EQ(jobs.stats().gave_way, 1u);
  GiveWay();
  EXPECT_EQ(frames.stats().gave_way, 0u) << "a thread of no pool gives way to none";
}

PoolOptions WithVisitors(std::size_t threads, std::size_t visitors) {
  PoolOptions options{"frames", threads, 10};
  options.visitors = visitors;
  options.visit_seconds = 0.001;
  return options;
}

// Visits in a thread of their own, since a thread has no leave for another one right after.
bool Visits(WorkerPool& pool, const Share& share, const std::function<void()>& meanwhile = {}) {
  bool may = false;
  testing::BoundedThread thread("a visitor", [&] {
    const WorkerPool::Visit visit = pool.TryVisit(share);
    may = visit != nullptr;
    if (may && meanwhile) meanwhile();
  });
  thread.Join();
  return may;
}

TEST(WorkerPoolTest, AVisitorsJobCountsLikeAnother) {
  Metrics metrics;
  PoolOptions options = WithVisitors(1, 1);
  options.metrics = &metrics;
  WorkerPool pool(options);
  EXPECT_TRUE(Visits(pool, {"ann", 1, 0.0001}, [&] {
    EXPECT_EQ(pool.stats().running, 1u);
    EXPECT_FALSE(Visits(pool, {"ben", 1, 0.0001})) << "one at a time";
    EXPECT_TRUE(pool.AwaitFreeThread(milliseconds::zero())) << "the worker's place stays its own";
  }));
  const PoolStats done = pool.stats();
  EXPECT_EQ(done.running, 0u);
  EXPECT_EQ(done.completed, 1u);
  EXPECT_GT(done.busy.count(), 0);
  EXPECT_NE(metrics.Text().find("arapd_queue_seconds_count{lane=\"frames\"} 1\n"),
            std::string::npos);
  EXPECT_FALSE(Visits(pool, {"ann", 1, 0.002})) << "that is long";
  pool.Stop();
  EXPECT_FALSE(Visits(pool, {"ann", 1, 0.0001}));
  EXPECT_FALSE(Visits(*std::make_unique<WorkerPool>(1, 1), {"ann", 1, 0.0001}));
}

TEST(WorkerPoolTest, AThreadThatHasVisitedGoesOnWithWhatWaits) {
  WorkerPool pool(WithVisitors(1, 1));
  const auto begin = std::chrono::steady_clock::now();
  // Of a thread that was stopped between the two visits nothing is said.
  for (bool again = true; again;) {
    ASSERT_LT(std::chrono::steady_clock::now() - begin, kPatience) << "it had leave every time";
    testing::BoundedThread thread("a visitor", [&] {
      EXPECT_TRUE(pool.TryVisit({"ann", 1, 0.0001}));
      again = pool.TryVisit({"ann", 1, 0.0001}) != nullptr;
    });
    thread.Join();
  }
}

TEST(WorkerPoolTest, AVisitChangesNobodysTurn) {
  WorkerPool pool(WithVisitors(1, 2));
  Blocker blocker(pool, "ann");
  EXPECT_FALSE(Visits(pool, {"ann", 1, 0.0001})) << "the only place is taken, by her too";
  EXPECT_TRUE(Visits(pool, {"ben", 1, 0.0001})) << "he has nothing else running";
  EXPECT_TRUE(pool.TryPost([] {}, {"ann", 2, 1}));
  EXPECT_FALSE(Visits(pool, {"ann", 1, 0.0001})) << "older work of hers waits";
  // Neither was served yet, and cas has waited for longer.
  EXPECT_TRUE(pool.TryPost([] {}, {"cas", 0, 1}));
  EXPECT_FALSE(Visits(pool, {"dan", 1, 0.0001}));
  blocker.Open();
  pool.Stop();
  EXPECT_EQ(pool.stats().completed, 4u);
}

TEST(WorkerPoolTest, HasAtLeastOneThread) { EXPECT_EQ(WorkerPool(0, 1).threads(), 1u); }

}  // namespace
}  // namespace arap::runtime
