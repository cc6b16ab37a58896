// Threads that help with a job of another lane: parts are taken once, jobs come first, and who is helped pays.
#include "server/runtime/helpers.h"

#include <atomic>
#include <chrono>
#include <future>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/cpu_timer.h"
#include "core/base/mutex.h"

namespace arap::runtime {
namespace {

constexpr std::chrono::seconds kPatience{60};

class HelpersTest : public ::testing::Test {
 protected:
  explicit HelpersTest(std::size_t threads = 3)
      : others_({.name = "others", .threads = threads, .queue = 10}),
        jobs_({.name = "jobs", .threads = 1, .queue = 10, .gives_way_to = &others_}) {}

  // Runs `job` in the job lane, to its end.
  template <class Job>
  void InJob(Job job, const std::string& owner = "ann") {
    std::promise<void> done;
    ASSERT_TRUE(jobs_.TryPost(
        [&] {
          job();
          done.set_value();
        },
        {owner, 0, 0}));
    ASSERT_EQ(done.get_future().wait_for(kPatience), std::future_status::ready);
  }

  static void Await(std::shared_future<void> future, const char* what) {
    EXPECT_EQ(future.wait_for(kPatience), std::future_status::ready) << what;
  }

  WorkerPool others_;
  WorkerPool jobs_;
};

// A promise that anybody may keep, and await.
struct Event {
  std::promise<void> promise;
  std::shared_future<void> future = promise.get_future().share();
};

TEST_F(HelpersTest, ThereIsNobodyWhereNoPoolGivesWay) {
  EXPECT_EQ(Helpers().crew(), nullptr);
  ASSERT_TRUE(others_.TryPost([&] { EXPECT_EQ(Helpers().crew(), nullptr); }));
  others_.Stop();
}

TEST_F(HelpersTest, EveryPartIsTakenOnce) {
  for (const std::size_t parts : {0u, 1u, 2u, 1000u}) {
    std::vector<std::atomic<int>> taken(parts);
    InJob([&] {
      Helpers helpers;
      ASSERT_NE(helpers.crew(), nullptr);
      for (int round = 0; round < 5; ++round) {
        helpers.crew()->Run(parts, [&](std::size_t part) { ++taken[part]; });
      }
    });
    for (const std::atomic<int>& each : taken) EXPECT_EQ(each, 5);
  }
}

TEST_F(HelpersTest, AsManyThreadsTakePartsAsThereAreProcessorsMeant) {
  // Three parts wait for one another, so that three threads are at them.
  Mutex mutex;
  std::set<std::thread::id> threads;
  std::atomic<int> there = 0;
  Event all;
  InJob([&] {
    Helpers helpers;
    helpers.crew()->Run(50, [&](std::size_t part) {
      {
        const MutexLock lock(&mutex);
        threads.insert(std::this_thread::get_id());
      }
      if (part >= 3) return;
      if (++there == 3) all.promise.set_value();
      Await(all.future, "others that take parts");
    });
  });
  EXPECT_EQ(threads.size(), 3u);
  EXPECT_GE(others_.stats().helped, 2u);
  EXPECT_EQ(others_.stats().completed, 0u);
}

TEST_F(HelpersTest, NobodyWaitsForThreadsThatHaveJobs) {
  Event open;
  std::vector<std::promise<void>> started(3);
  for (std::promise<void>& each : started) {
    ASSERT_TRUE(others_.TryPost([&each, future = open.future] {
      each.set_value();
      Await(future, "the end of the test");
    }));
  }
  for (std::promise<void>& each : started) Await(each.get_future().share(), "a thread");
  InJob([&] {
    const auto here = std::this_thread::get_id();
    Helpers helpers;
    helpers.crew()->Run(20, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), here); });
    EXPECT_EQ(helpers.seconds(), 0);
  });
  EXPECT_EQ(others_.stats().helped, 0u);
  open.promise.set_value();
}

// One helper.
class OneHelperTest : public HelpersTest {
 protected:
  OneHelperTest() : HelpersTest(2) {}
};

TEST_F(OneHelperTest, NobodyHelpsWhileAJobNeedsTheProcessor) {
  Event helping, started, all;
  std::atomic<int> helped = 0;
  std::thread client([&] {
    Await(helping.future, "a helper");
    // It runs until all parts are done, in the thread that does not help.
    EXPECT_TRUE(others_.TryPost([&, future = all.future] {
      started.promise.set_value();
      Await(future, "all parts");
    }));
  });
  InJob([&] {
    const auto here = std::this_thread::get_id();
    Helpers helpers;
    helpers.crew()->Run(10, [&](std::size_t) {
      if (std::this_thread::get_id() != here && ++helped == 1) helping.promise.set_value();
      Await(started.future, "the job");
    });
    all.promise.set_value();
  });
  client.join();
  EXPECT_EQ(helped, 1);
}

TEST_F(OneHelperTest, WhoIsHelpedPays) {
  // Time of the processor, in a thread that is not `here`.
  const auto burn = [](double milliseconds) {
    CpuTimer timer;
    double spent = 0;
    while ((spent += timer.Lap()) < milliseconds) {
    }
  };
  InJob(
      [&] {
        const auto here = std::this_thread::get_id();
        Event burnt;
        Helpers helpers;
        std::atomic<bool> first = true;
        helpers.crew()->Run(2, [&](std::size_t) {
          if (std::this_thread::get_id() == here) return Await(burnt.future, "the helper");
          if (!first.exchange(false)) return;
          burn(200);
          burnt.promise.set_value();
        });
        EXPECT_GE(helpers.seconds(), 0.2);
      },
      "ann");
  InJob([&] { burn(50); }, "ben");
  // Both want the next turn.
  Event open, blocked, done;
  ASSERT_TRUE(jobs_.TryPost(
      [&] {
        blocked.promise.set_value();
        Await(open.future, "both jobs");
      },
      {"cas", 0, 0}));
  Await(blocked.future, "the job lane");
  std::string order;
  ASSERT_TRUE(jobs_.TryPost([&] { order += "a"; }, {"ann", 0, 0}));
  ASSERT_TRUE(jobs_.TryPost([&] { order += "b"; }, {"ben", 0, 0}));
  open.promise.set_value();
  jobs_.Stop();
  EXPECT_EQ(order, "ba");
}

TEST_F(HelpersTest, PartsAreDoneAlsoWhenTheHelpersAreSentHome) {
  std::atomic<int> done = 0;
  InJob([&] {
    const auto here = std::this_thread::get_id();
    Helpers helpers;
    helpers.crew()->Run(100, [&](std::size_t) {
      if (std::this_thread::get_id() == here) others_.Stop();
      ++done;
    });
  });
  EXPECT_EQ(done, 100);
}

}  // namespace
}  // namespace arap::runtime
