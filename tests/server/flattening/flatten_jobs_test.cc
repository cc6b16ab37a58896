// Below the wire: jobs wait their turn, end, are cancelled, and are found again by the next server.
#include "server/flattening/flatten_jobs.h"

#include <atomic>
#include <future>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/try.h"
#include "server/engine.h"
#include "tests/server/store/temp_dir.h"
#include "tests/support/bounded.h"
#include "tests/support/fake_clock.h"

namespace arap::app {
namespace {

using std::chrono::minutes;

const Caller kAnn{"ann", Role::kUser, {}};
const Caller kBen{"ben", Role::kUser, {}};

// What jobs do here: they answer their request twice, once they may.
class FlattenJobsTest : public ::testing::Test {
 protected:
  FlattenJobsTest() { Start(); }
  ~FlattenJobsTest() override { Stop(); }

  // A server in the place of the one before, with what it has stored.
  void Start() {
    Stop();
    may_ = std::promise<void>();
    let_ = false;
    store::StoreOptions options;
    options.store = "sqlite:" + (dir_ / "state");
    auto stores = store::OpenStores(options);
    ASSERT_TRUE(stores) << stores.error().message;
    engine_ = std::make_unique<Engine>(limits_, Lanes{1, 1, 1}, clock_, *std::move(stores));
    jobs().Do([go = may_.get_future().share()](
                  const Caller&, const std::string& request, const CancelToken& cancel,
                  const FlattenProgress& progress) -> Result<std::string> {
      progress("cutting", 0.25);
      go.wait();
      CHECK_OK(cancel.Check());
      if (request == "large") return Fail(FaultKind::kOutOfMemory, "No room.");
      if (request == "bad") return Fail(Fault(FaultKind::kNotADisk, "No.").Field("mesh"));
      return request + request;
    });
    for (const Caller& caller : {kAnn, kBen}) {
      ASSERT_TRUE(engine_->sessions.Create(caller, {"s", minutes(60), {}}));
    }
  }
  void Stop() {
    if (!engine_) return;
    jobs().Drain();
    Let();
    engine_.reset();
  }

  // Jobs may end.
  void Let() {
    if (!std::exchange(let_, true)) may_.set_value();
  }

  FlattenJobs& jobs() { return engine_->flatten_jobs; }
  SessionRegistry& sessions() { return engine_->sessions; }
  const store::Stores& stores() { return engine_->stores; }

  Result<JobView> Submit(const Caller& caller, const std::string& job, const std::string& request) {
    return jobs().Submit(caller, "s", job, request, 5);
  }
  JobView Look(const Caller& caller, const std::string& job) {
    auto view = jobs().Look(caller, "s", job);
    EXPECT_TRUE(view) << view.error().message;
    return view.value_or(JobView{});
  }
  ::testing::AssertionResult Ends(const Caller& caller, const std::string& job) {
    return testing::Await("the job has ended", [&] { return Look(caller, job).ended(); });
  }
  ::testing::AssertionResult Runs(const Caller& caller, const std::string& job) {
    return testing::Await("the job runs", [&] { return Look(caller, job).phase == "cutting"; });
  }
  Result<std::string> ResultOf(const Caller& caller, const std::string& job,
                               std::size_t most = 1000) {
    return jobs().ResultOf(caller, "s", job, most).map([](const JobResult& r) { return r.bytes; });
  }

 private:
  const testing::TempDir dir_;
  const Limits limits_;
  runtime::FakeClock clock_;
  std::promise<void> may_;
  bool let_ = true;
  std::unique_ptr<Engine> engine_;
};

TEST_F(FlattenJobsTest, AJobRunsAndItsResultIsThere) {
  const auto begun = Submit(kAnn, "a", "xy");
  ASSERT_TRUE(begun) << begun.error().message;
  EXPECT_FALSE(begun->ended());
  EXPECT_TRUE(Runs(kAnn, "a"));
  const JobView running = Look(kAnn, "a");
  EXPECT_EQ(running.state, JobState::kRunning);
  EXPECT_GE(running.fraction, 0.25);
  EXPECT_LT(running.fraction, 1);
  EXPECT_EQ(ResultOf(kAnn, "a").error().kind, FaultKind::kProtocol) << "not done";
  Let();
  EXPECT_TRUE(Ends(kAnn, "a"));
  const JobView done = Look(kAnn, "a");
  EXPECT_EQ(done.state, JobState::kDone);
  EXPECT_EQ(done.fraction, 1);
  EXPECT_EQ(done.result_bytes, 4u);
  EXPECT_EQ(ResultOf(kAnn, "a").value_or(""), "xyxy");
  EXPECT_EQ(ResultOf(kAnn, "a", 3).error().kind, FaultKind::kLimitExceeded) << "too large";
}

TEST_F(FlattenJobsTest, AskingAgainIsTheSameJob) {
  Let();
  ASSERT_TRUE(Submit(kAnn, "a", "xy"));
  EXPECT_TRUE(Ends(kAnn, "a"));
  EXPECT_EQ(Submit(kAnn, "a", "xy")->state, JobState::kDone);
  EXPECT_EQ(Submit(kAnn, "a", "other").error().kind, FaultKind::kAlreadyExists);
  EXPECT_EQ(Submit(kAnn, "no/name", "xy").error().kind, FaultKind::kInvalidName);
  EXPECT_EQ(jobs().Submit(kAnn, "nowhere", "a", "xy", 1).error().kind, FaultKind::kNotFound);
  EXPECT_EQ(jobs().Look(kBen, "s", "a").error().kind, FaultKind::kNotFound) << "somebody else's";
}

TEST_F(FlattenJobsTest, AFailureIsKept) {
  Let();
  ASSERT_TRUE(Submit(kAnn, "a", "bad"));
  EXPECT_TRUE(Ends(kAnn, "a"));
  EXPECT_EQ(Look(kAnn, "a").state, JobState::kFailed);
  Start();
  const auto result = ResultOf(kAnn, "a");
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, FaultKind::kNotADisk);
  EXPECT_EQ(result.error().message, "No.");
  EXPECT_EQ(result.error().field, "mesh");
}

TEST_F(FlattenJobsTest, WhatFailedForLackOfRoomMayBeTriedAgain) {
  Let();
  ASSERT_TRUE(Submit(kAnn, "a", "large"));
  EXPECT_TRUE(Ends(kAnn, "a"));
  EXPECT_EQ(ResultOf(kAnn, "a").error().kind, FaultKind::kOutOfMemory);
  EXPECT_FALSE(Submit(kAnn, "a", "large")->ended());
  EXPECT_TRUE(Ends(kAnn, "a"));
}

TEST_F(FlattenJobsTest, OwnersTakeTurns) {
  ASSERT_TRUE(Submit(kAnn, "0", "x"));
  EXPECT_TRUE(Runs(kAnn, "0"));
  ASSERT_TRUE(Submit(kAnn, "1", "x"));
  ASSERT_TRUE(Submit(kAnn, "2", "x"));
  ASSERT_TRUE(Submit(kBen, "3", "x"));
  // Ben's one job waits for Ann's next at most, her last one for his.
  EXPECT_EQ(Look(kAnn, "1").place, 1u);
  EXPECT_EQ(Look(kBen, "3").place, 1u);
  EXPECT_EQ(Look(kAnn, "2").place, 2u);
  EXPECT_GT(Look(kAnn, "2").expected_seconds, Look(kAnn, "1").expected_seconds);
  EXPECT_EQ(jobs().waiting(), 3u);
  Let();
  for (const char* job : {"0", "1", "2"}) EXPECT_TRUE(Ends(kAnn, job));
  EXPECT_TRUE(Ends(kBen, "3"));
}

TEST_F(FlattenJobsTest, CancelledJobsEndWithoutAResult) {
  ASSERT_TRUE(Submit(kAnn, "runs", "x"));
  EXPECT_TRUE(Runs(kAnn, "runs"));
  ASSERT_TRUE(Submit(kAnn, "waits", "x"));
  for (const char* job : {"waits", "runs"}) {
    const auto view = jobs().Cancel(kAnn, "s", job);
    ASSERT_TRUE(view) << view.error().message;
    EXPECT_EQ(view->state, JobState::kCancelled);
    EXPECT_EQ(ResultOf(kAnn, job).error().kind, FaultKind::kCancelled);
  }
  ASSERT_TRUE(Submit(kAnn, "next", "x"));
  Let();
  EXPECT_TRUE(Ends(kAnn, "next"));
  EXPECT_EQ(Look(kAnn, "runs").state, JobState::kCancelled) << "what it made meanwhile is dropped";
  EXPECT_EQ(jobs().Cancel(kAnn, "s", "next")->state, JobState::kDone) << "harmless";
}

TEST_F(FlattenJobsTest, TheNextServerFindsAndEndsThem) {
  ASSERT_TRUE(Submit(kAnn, "ran", "x"));
  EXPECT_TRUE(Runs(kAnn, "ran"));
  ASSERT_TRUE(Submit(kAnn, "waited", "y"));
  Start();
  EXPECT_FALSE(Look(kAnn, "ran").ended());
  Let();
  EXPECT_TRUE(Ends(kAnn, "ran"));
  EXPECT_TRUE(Ends(kAnn, "waited"));
  Start();
  EXPECT_EQ(ResultOf(kAnn, "ran").value_or(""), "xx");
  EXPECT_EQ(ResultOf(kAnn, "waited").value_or(""), "yy");
}

TEST_F(FlattenJobsTest, ADrainingServerTakesNone) {
  jobs().Drain();
  EXPECT_EQ(Submit(kAnn, "a", "x").error().kind, FaultKind::kDraining);
}

TEST_F(FlattenJobsTest, AJobEndsWithItsSession) {
  ASSERT_TRUE(Submit(kAnn, "a", "x"));
  EXPECT_TRUE(Runs(kAnn, "a"));
  ASSERT_TRUE(sessions().Delete("ann", "s"));
  Let();
  ASSERT_TRUE(Submit(kBen, "b", "x"));
  EXPECT_TRUE(Ends(kBen, "b"));
  EXPECT_EQ(jobs().Look(kAnn, "s", "a").error().kind, FaultKind::kNotFound);
}

TEST_F(FlattenJobsTest, WhoListensHearsOfTheEnd) {
  ASSERT_TRUE(Submit(kAnn, "a", "x"));
  EXPECT_TRUE(Runs(kAnn, "a"));
  std::promise<void> told;
  std::atomic<bool> once = false;
  std::shared_ptr<FlattenJobs::Listening> listening;
  ASSERT_TRUE(jobs().Look(
      kAnn, "s", "a",
      [&] {
        if (Look(kAnn, "a").ended() && !once.exchange(true)) told.set_value();
      },
      &listening));
  Let();
  EXPECT_EQ(told.get_future().wait_for(testing::kLongest), std::future_status::ready);
}

TEST_F(FlattenJobsTest, RequestsAndResultsAreBytesOfTheirOwner) {
  Let();
  const std::string request(10'000, 'x');
  const auto stored = [&] { return stores().specs->UsageOf("ann")->bytes; };
  const std::size_t before = stored();
  ASSERT_TRUE(Submit(kAnn, "a", request));
  EXPECT_TRUE(Ends(kAnn, "a"));
  EXPECT_GE(stored(), before + 30'000);
  EXPECT_LT(stored(), before + 31'000);

  Caller small = kAnn;
  small.limits.max_stored_bytes = stored() + 5'000;
  const auto refused = Submit(small, "b", request);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(DetailOf(refused.error(), "quota"), "max_stored_bytes_per_owner");
  EXPECT_EQ(jobs().Look(kAnn, "s", "b").error().kind, FaultKind::kNotFound);

  // Room for the request and none for the result, then for both.
  small.limits.max_stored_bytes = stored() + 15'000;
  ASSERT_TRUE(Submit(small, "b", request));
  EXPECT_TRUE(Ends(kAnn, "b"));
  const auto result = ResultOf(kAnn, "b");
  ASSERT_FALSE(result);
  EXPECT_EQ(DetailOf(result.error(), "quota"), "max_stored_bytes_per_owner");
  small.limits.max_stored_bytes = stored() + 25'000;
  ASSERT_TRUE(Submit(small, "b", request));
  EXPECT_TRUE(Ends(kAnn, "b"));
  EXPECT_EQ(ResultOf(kAnn, "b", 100'000).value_or("").size(), 20'000u);
}

TEST_F(FlattenJobsTest, ASessionHasRoomForSoMany) {
  Let();
  for (std::size_t k = 0; k < kMaxJobsPerSession; ++k) {
    ASSERT_TRUE(Submit(kAnn, std::to_string(k), "x"));
  }
  const auto refused = Submit(kAnn, "more", "x");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(DetailOf(refused.error(), "quota"), "max_jobs_per_session");
}

}  // namespace
}  // namespace arap::app
