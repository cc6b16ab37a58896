// Jobs that are done along with another one.
#include <future>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/cpu_timer.h"
#include "server/runtime/metrics.h"
#include "server/runtime/worker_pool.h"
#include "tests/server/runtime/blocker.h"

namespace arap::runtime {
namespace {

// What jobs with company read.
constexpr int kOneMesh = 0, kOtherMesh = 0;

class TakeAlongTest : public ::testing::Test {
 protected:
  // A job that takes another one along, if it can, and notes both.
  bool Post(WorkerPool& pool, std::string name, const void* reads, Share share = {}) {
    const auto job = [this, name] {
      order_ += name;
      if (const auto other = std::static_pointer_cast<std::string>(TakeAlong())) {
        order_ += "+" + *other;
        EXPECT_EQ(TakeAlong(), nullptr) << "one is enough";
      }
      order_ += " ";
    };
    return pool.Continue(job, std::move(share), {reads, std::make_shared<std::string>(name)});
  }

  static Company Reading(const void* memory) { return {memory, std::make_shared<int>(1)}; }

  std::string order_;  // of the only thread that runs jobs
};

TEST_F(TakeAlongTest, JobsThatReadTheSameAreDoneTogether) {
  Metrics metrics;
  WorkerPool pool({"lane", 1, 10, &metrics});
  Blocker blocker(pool);
  EXPECT_TRUE(Post(pool, "a", &kOneMesh, {"ann", 1}));
  EXPECT_TRUE(Post(pool, "b", &kOtherMesh, {"ann", 2}));
  EXPECT_TRUE(Post(pool, "c", &kOneMesh, {"ann", 3}));
  EXPECT_TRUE(Post(pool, "d", nullptr, {"ann", 4}));
  EXPECT_TRUE(Post(pool, "e", &kOneMesh, {"ann", 5}));
  EXPECT_TRUE(Post(pool, "f", nullptr, {"ann", 6}));
  blocker.Open();
  pool.Stop();
  EXPECT_EQ(order_, "a+c b d e f ");
  EXPECT_EQ(pool.stats().taken_along, 1u);
  EXPECT_EQ(pool.stats().completed, 7u);
  EXPECT_NE(metrics.Text().find("arapd_queue_seconds_count{lane=\"lane\"} 7\n"), std::string::npos);
  EXPECT_EQ(TakeAlong(), nullptr) << "in a thread of no pool";
}

TEST_F(TakeAlongTest, WhatAFreeThreadCanTakeIsLeftToIt) {
  std::promise<void> done, over;  // outlive the pool
  WorkerPool pool(2, 10);
  EXPECT_TRUE(pool.Continue(
      [&] {
        EXPECT_TRUE(pool.Continue([&done] { done.set_value(); }, {}, Reading(&kOneMesh)));
        EXPECT_EQ(TakeAlong(), nullptr);
        EXPECT_EQ(done.get_future().wait_for(kPatience), kReady);
        over.set_value();
      },
      {}, Reading(&kOneMesh)));
  EXPECT_EQ(over.get_future().wait_for(kPatience), kReady);
  pool.Stop();
  EXPECT_EQ(pool.stats().taken_along, 0u);
}

TEST_F(TakeAlongTest, ShortWorkKeepsItsPlace) {
  PoolOptions options{"frames", 1, 10};
  options.short_seconds = 0.05;
  std::promise<void> first, second, over;  // outlive the pool
  WorkerPool pool(options);
  const auto end = [](std::promise<void>& promise) {
    return [&promise] {
      EXPECT_EQ(TakeAlong(), nullptr) << "the short place is for one";
      promise.set_value();
    };
  };
  EXPECT_TRUE(pool.Continue(
      [&] {
        EXPECT_TRUE(pool.Continue(end(first), {"ann", 2, 0.01}, Reading(&kOneMesh)));
        EXPECT_TRUE(pool.Continue(end(second), {"ann", 3, 0.01}, Reading(&kOneMesh)));
        EXPECT_EQ(TakeAlong(), nullptr) << "they wait for one another only";
        EXPECT_EQ(first.get_future().wait_for(kPatience), kReady);
        EXPECT_EQ(second.get_future().wait_for(kPatience), kReady);
        over.set_value();
      },
      {"ann", 1, 60}, Reading(&kOneMesh)));
  EXPECT_EQ(over.get_future().wait_for(kPatience), kReady);
  pool.Stop();
  EXPECT_EQ(pool.stats().taken_along, 0u);
}

TEST_F(TakeAlongTest, NobodyIsAnsweredMuchLaterForCompany) {
  PoolOptions options{"frames", 1, 10};
  options.short_seconds = 0.05;
  for (const auto& [own, other] : {std::pair(0.01, 60.0), std::pair(0.1, 1.0)}) {
    WorkerPool pool(options);
    Blocker blocker(pool);
    const auto alone = [] { EXPECT_EQ(TakeAlong(), nullptr); };
    EXPECT_TRUE(pool.Continue(alone, {"ann", 1, own}, Reading(&kOneMesh)));
    EXPECT_TRUE(pool.Continue(alone, {"ann", 2, other}, Reading(&kOneMesh)));
    blocker.Open();
    pool.Stop();
    EXPECT_EQ(pool.stats().completed, 3u) << own;
  }
}

void Burn(double wanted) {
  CpuTimer timer;
  for (double spent = 0; spent < wanted;) spent += timer.Lap();
}

TEST_F(TakeAlongTest, EachOwnerPaysHalf) {
  std::promise<void> posted;  // outlives the pool
  WorkerPool pool(1, 10);
  Blocker blocker(pool);
  EXPECT_TRUE(pool.Continue(
      [] {
        EXPECT_NE(TakeAlong(), nullptr);
        Burn(100);
      },
      {"ann", 1}, Reading(&kOneMesh)));
  EXPECT_TRUE(pool.Continue([] { FAIL() << "runs alone"; }, {"ben", 1}, Reading(&kOneMesh)));
  EXPECT_TRUE(pool.Continue(
      [&] {
        Burn(75);
        EXPECT_TRUE(Post(pool, "cas", nullptr, {"cas", 1}));
        EXPECT_TRUE(Post(pool, "ann", nullptr, {"ann", 1}));
        EXPECT_TRUE(Post(pool, "ben", nullptr, {"ben", 1}));
        posted.set_value();
      },
      {"cas", 1}));
  blocker.Open();
  EXPECT_EQ(posted.get_future().wait_for(kPatience), kReady);
  pool.Stop();
  EXPECT_TRUE(order_ == "ann ben cas " || order_ == "ben ann cas ") << order_;
}

}  // namespace
}  // namespace arap::runtime
