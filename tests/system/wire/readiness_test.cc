// Readiness: what makes a server not ready, and what does not.
#include "server/host/readiness.h"

#include <gtest/gtest.h>

#include "tests/support/fake_clock.h"

namespace arap::host {
namespace {

using State = Verdict::State;
using std::chrono::milliseconds;
using std::chrono::seconds;

class ReadinessTest : public ::testing::Test {
 protected:
  ReadinessTest() {
    readiness_.WatchLane("interactive", [this] { return stats_; });
  }

  runtime::PoolStats stats_;
  runtime::FakeClock clock_;
  Readiness readiness_{seconds(10), clock_};
};

TEST_F(ReadinessTest, IdleAndBusyLanesAreReady) {
  EXPECT_TRUE(readiness_.Check().ready());
  stats_.running = 1;
  stats_.oldest_running = seconds(10);
  stats_.waiting = 100;
  stats_.oldest_waiting = seconds(60);  // a long queue that moves
  stats_.since_finish = seconds(1);
  EXPECT_TRUE(readiness_.Check().ready());
  EXPECT_TRUE(readiness_.Check().why.empty());
}

TEST_F(ReadinessTest, JobThatDoesNotEndIsStuck) {
  stats_.oldest_running = milliseconds(10'001);
  const Verdict verdict = readiness_.Check();
  EXPECT_EQ(verdict.state, State::kStuck);
  EXPECT_NE(verdict.why.find("interactive"), std::string::npos) << verdict.why;
}

TEST_F(ReadinessTest, QueueThatDoesNotMoveIsStuck) {
  stats_.since_finish = seconds(11);
  EXPECT_TRUE(readiness_.Check().ready()) << "nothing waits";
  stats_.waiting = 3;
  stats_.oldest_waiting = seconds(2);
  EXPECT_TRUE(readiness_.Check().ready()) << "it has only begun to wait";
  stats_.oldest_waiting = seconds(11);
  EXPECT_EQ(readiness_.Check().state, State::kStuck);
}

TEST_F(ReadinessTest, StoreThatFailsIsToldWithoutItsMessage) {
  Status answer;
  readiness_.WatchStore([&] { return answer; });
  readiness_.Probe();
  EXPECT_TRUE(readiness_.Check().ready());
  answer = Fail(FaultKind::kStoreUnavailable, "cannot reach redis.secret.example");
  EXPECT_TRUE(readiness_.Check().ready()) << "asking is the probe's";
  readiness_.Probe();
  EXPECT_EQ(readiness_.Check().state, State::kStore);
  EXPECT_EQ(readiness_.Check().why.find("secret"), std::string::npos);
  answer = {};
  readiness_.Probe();
  EXPECT_TRUE(readiness_.Check().ready());
}

TEST_F(ReadinessTest, StoreThatDoesNotAnswerIsNotReady) {
  State early = State::kDraining, late = State::kDraining;
  readiness_.WatchStore([&]() -> Status {
    clock_.Advance(seconds(9));
    early = readiness_.Check().state;
    clock_.Advance(seconds(2));
    late = readiness_.Check().state;
    return {};
  });
  readiness_.Probe();
  EXPECT_EQ(early, State::kReady);
  EXPECT_EQ(late, State::kStore);
  EXPECT_TRUE(readiness_.Check().ready());
}

TEST_F(ReadinessTest, ServerThatLetsNobodyInIsDeafUntilItDoes) {
  readiness_.TellDialled(Fail(FaultKind::kInternal, "Nobody is let in."));
  EXPECT_EQ(readiness_.Check().state, State::kDeaf);
  clock_.Advance(seconds(9));
  readiness_.TellDialled(Fail(FaultKind::kInternal, "Nobody is let in."));
  EXPECT_FALSE(readiness_.IsDeaf()) << "it may still recover";
  clock_.Advance(seconds(2));
  EXPECT_TRUE(readiness_.IsDeaf());
  readiness_.TellDialled({});
  EXPECT_FALSE(readiness_.IsDeaf());
  EXPECT_TRUE(readiness_.Check().ready());
}

TEST_F(ReadinessTest, DrainingComesBeforeAllElse) {
  stats_.oldest_running = seconds(60);
  readiness_.AnnounceStop();
  EXPECT_EQ(readiness_.Check().state, State::kDraining);
}

TEST_F(ReadinessTest, WeaknessesOfTheStoreAreToldAndGraveOnesCount) {
  std::vector<store::Weakness> weaknesses;
  readiness_.WatchStore([] { return Status(); }, [&] { return weaknesses; });
  EXPECT_TRUE(readiness_.Check().ready());
  EXPECT_EQ(readiness_.Check().why, "");
  weaknesses = {{"mass_removal", "Much goes.", false}};
  EXPECT_TRUE(readiness_.Check().ready());
  EXPECT_EQ(readiness_.Check().why, "Much goes.");
  weaknesses.push_back({"evicts", "It evicts.", true});
  EXPECT_EQ(readiness_.Check().state, State::kStore);
  EXPECT_EQ(readiness_.Check().why, "Much goes. It evicts.");
}

}  // namespace
}  // namespace arap::host
