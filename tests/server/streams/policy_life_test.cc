// How long a live stream lives and how fast it may be: signs of life, rate and load, the session,
// the ends. stream_policy.h states the rules.
#include <chrono>

#include <gtest/gtest.h>

#include "tests/server/streams/policy_fixture.h"

namespace arap::testing {
namespace {

using std::chrono::milliseconds;
using Lane = app::StreamJob::Lane;

// Signs of life.

TEST_P(DeliveryTest, PongComesWhileWorkWaitsAndBeforeTheAnswers) {
  stream_.Update(1);
  stream_.Ping(41);
  ExpectPong(41);
  stream_.FinishJob();  // being written
  stream_.Update(2);
  stream_.FinishJob();  // waits
  stream_.Ping(42);
  EXPECT_FALSE(stream_.reading) << "nothing is read while a pong waits";
  ExpectShape(1);
  EXPECT_TRUE(stream_.reading);
  ExpectPong(42);
  ExpectShape(2);
}

TEST_P(DeliveryTest, SilenceEndsTheStream) {
  const milliseconds limit = stream_.limits.max_stream_idle;
  stream_.Advance(limit - milliseconds(1));
  EXPECT_FALSE(stream_.Sweep());
  stream_.Ping(1);
  ExpectPong(1);
  stream_.Advance(limit - milliseconds(1));
  EXPECT_FALSE(stream_.Sweep());
  EXPECT_FALSE(stream_.finished.has_value());
  stream_.Advance(milliseconds(1));
  EXPECT_FALSE(stream_.Sweep()) << "no write keeps it";
  ExpectEnd(FaultKind::kStreamIdle);
}

TEST_P(DeliveryTest, SilenceCancelsAWriteThatDoesNotEnd) {
  stream_.Update(1);
  stream_.FinishJob();
  stream_.Advance(stream_.limits.max_stream_idle);
  EXPECT_TRUE(stream_.Sweep());
  EXPECT_FALSE(stream_.Sweep()) << "once is enough";
  stream_.FinishWrite(false);
  ExpectEnd(FaultKind::kCancelled);
}

TEST_F(PolicyTest, SilenceWithoutLimitIsFine) {
  Limits limits;
  limits.max_stream_idle = milliseconds(0);
  PolicyDriver stream(limits);
  stream.Advance(std::chrono::hours(100));
  EXPECT_FALSE(stream.Sweep());
  EXPECT_FALSE(stream.finished.has_value());
}

// Rate and load.

Limits TwoASecond() {
  Limits limits;
  limits.max_stream_fps = 2;
  return limits;
}

TEST_F(PolicyTest, RateIsABurstThenRefused) {
  PolicyDriver stream(TwoASecond());
  stream.OpenAndAnswer(kLatest);
  for (std::uint64_t i = 1; i <= 3; ++i) {
    stream.Update(i);
    if (i == 3) break;
    ASSERT_TRUE(stream.job.has_value()) << i;
    stream.FinishJob();
    stream.FinishWrite();
  }
  ASSERT_TRUE(stream.writing && stream.writing->fault);
  EXPECT_EQ(stream.writing->fault->details.front().second, "max_stream_fps");
  stream.FinishWrite();
  stream.Advance(milliseconds(500));
  stream.Update(4);
  EXPECT_TRUE(stream.job.has_value());
  EXPECT_EQ(stream.broken, "");
}

TEST_F(PolicyTest, WhatIsTooFastWaitsWhileAnswersAreUnderWay) {
  PolicyDriver stream(TwoASecond());
  stream.OpenAndAnswer(kLatest);
  stream.Update(1);
  stream.Update(2);
  stream.Update(3);
  EXPECT_FALSE(stream.reading) << "held";
  stream.Advance(milliseconds(500));
  stream.FinishJob();
  ASSERT_TRUE(stream.job.has_value());
  EXPECT_EQ(stream.job->sequence, 3u) << "it has its token now";
  EXPECT_TRUE(stream.reading);
  EXPECT_EQ(stream.broken, "");
}

TEST_F(PolicyTest, RefusedUpdateCostsItsTokenOnce) {
  PolicyDriver stream(TwoASecond());
  stream.OpenAndAnswer(kLatest);
  stream.Update(1);
  stream.Update(2, {At("nobody", 0, 0)});  // held, tried again at every event
  static_cast<void>(stream.Sweep());
  static_cast<void>(stream.Sweep());
  stream.FinishJob();
  stream.FinishWrite();
  ASSERT_TRUE(stream.writing && stream.writing->fault);
  EXPECT_EQ(stream.writing->fault->kind, FaultKind::kUnknownHandle);
  stream.FinishWrite();
  stream.Update(3);
  ASSERT_TRUE(stream.writing && stream.writing->fault);
  EXPECT_EQ(stream.writing->fault->kind, FaultKind::kLimitExceeded);
}

TEST_P(DeliveryTest, WakingUpIsAdmittedAgain) {
  ASSERT_EQ(stream_.asked.size(), 1u) << "when it opened";
  stream_.Update(1);
  stream_.FinishJob();
  ExpectShape(1);
  ASSERT_EQ(stream_.asked.size(), 2u) << "it counts from its first update on";
  EXPECT_EQ(stream_.asked[1].first, "wake");
  stream_.Update(2);
  stream_.FinishJob();
  ExpectShape(2);
  EXPECT_EQ(stream_.asked.size(), 2u) << "awake";
  stream_.Advance(app::kAwake);
  stream_.too_busy = Fault(FaultKind::kLimitExceeded, "Too busy.");
  stream_.Update(3);
  ExpectError(3, FaultKind::kLimitExceeded);
  EXPECT_EQ(stream_.asked.size(), 3u);
  stream_.too_busy.reset();
  stream_.Update(4);
  ExpectUpdateJob(4);
  EXPECT_EQ(stream_.asked.size(), 4u);
}

TEST_P(DeliveryTest, WhileItIsAwakeItSaysSoNowAndThen) {
  for (std::uint64_t i = 1; i <= 100; ++i) {
    stream_.Advance(milliseconds(20));
    stream_.Update(i);
    stream_.FinishJob();
    ExpectShape(i);
  }
  EXPECT_EQ(stream_.asked.size(), 2u);
  EXPECT_GE(stream_.awake_shares.size(), 3u);
  EXPECT_LE(stream_.awake_shares.size(), 5u);
  EXPECT_NEAR(stream_.awake_shares.back(), 0.03, 1e-9) << "fifty a second is no claim";
}

TEST_P(DeliveryTest, LongFramesAreJobs) {
  stream_.frame_seconds = 10;
  stream_.Update(1);
  ExpectUpdateJob(1);
  stream_.FinishJob();
  ExpectShape(1);
  stream_.Update(2);
  ASSERT_TRUE(stream_.job.has_value());
  EXPECT_EQ(stream_.job->lane, Lane::kJobs) << "the first one took ten seconds";
  EXPECT_GT(stream_.job->seconds, 1);
  stream_.frame_seconds = 0;
  for (std::uint64_t i = 2; i < 50; ++i) {
    stream_.FinishJob();
    ExpectShape(i);
    stream_.Update(i + 1);
  }
  ExpectUpdateJob(50);
}

TEST_P(DeliveryTest, ManyPicksMakeAJob) {
  stream_.Update(1, {}, std::vector<Complex>(1'000'000));
  ASSERT_TRUE(stream_.job.has_value());
  EXPECT_EQ(stream_.job->lane, Lane::kJobs);
}

// The session.

TEST_P(DeliveryTest, UpdatesAndEditsExtendTheSession) {
  stream_.Update(1);
  EXPECT_EQ(stream_.touched, 1);
  stream_.FinishJob();
  ExpectShape(1);
  stream_.Edit(2);
  EXPECT_EQ(stream_.touched, 2);
  stream_.Ping(1);
  EXPECT_EQ(stream_.touched, 2);
}

TEST_P(DeliveryTest, EndOfTheSessionEndsTheStream) {
  stream_.session_over = true;
  stream_.Update(1);
  ExpectEnd(FaultKind::kNotFound);
}

TEST_P(DeliveryTest, EndOfTheSessionIsSeenByAnEdit) {
  stream_.session_over = true;
  stream_.Edit(1);
  ExpectEnd(FaultKind::kNotFound);
}

// Ending.

TEST_P(DeliveryTest, EndFromOutsideLetsTheJobInWorkOut) {
  stream_.Update(1);
  stream_.Update(2);
  stream_.Ping(1);
  stream_.End(Fault(FaultKind::kDraining, "Draining."));
  stream_.End(Fault(FaultKind::kNotFound, "Only the first counts."));
  ExpectPong(1);
  EXPECT_FALSE(stream_.finished.has_value());
  stream_.FinishJob();
  EXPECT_FALSE(stream_.job.has_value()) << "2 does not start";
  ExpectShape(1);
  ExpectEnd(FaultKind::kDraining);
}

TEST_P(DeliveryTest, CancelledStreamWaitsForItsJobAndWritesNothing) {
  stream_.Update(1);
  stream_.Cancel();
  EXPECT_FALSE(stream_.finished.has_value());
  stream_.FinishJob();
  EXPECT_FALSE(stream_.writing.has_value());
  ExpectEnd(FaultKind::kCancelled);
}

TEST_P(DeliveryTest, ReaderThatIsGoneEndsTheStream) {
  stream_.Update(1);
  stream_.FinishJob();
  stream_.FinishWrite(false);
  ExpectEnd(FaultKind::kCancelled);
}

TEST_P(DeliveryTest, WhoeverDoesNotReadTheLastAnswerIsCutOff) {
  stream_.Update(1);
  stream_.FinishJob();
  ASSERT_TRUE(stream_.writing.has_value());
  stream_.End(Fault(FaultKind::kDraining, "Draining."));
  EXPECT_FALSE(stream_.Sweep());
  stream_.Advance(app::kLastWrite - milliseconds(1));
  EXPECT_FALSE(stream_.Sweep());
  stream_.Advance(milliseconds(1));
  EXPECT_TRUE(stream_.Sweep());
  stream_.Cancel();
  EXPECT_FALSE(stream_.Sweep()) << "once is enough";
  stream_.FinishWrite(false);
  ExpectEnd(FaultKind::kCancelled);
}

TEST_P(DeliveryTest, HalfCloseAnswersWhatIsPending) {
  stream_.Update(1);
  stream_.Update(2);
  stream_.HalfClose();
  EXPECT_FALSE(stream_.finished.has_value());
  stream_.FinishJob();
  ExpectShape(1);
  EXPECT_FALSE(stream_.finished.has_value());
  stream_.FinishJob();
  ExpectShape(2);
  ExpectGoodEnd();
}

TEST_P(DeliveryTest, HalfCloseOfAnIdleStreamIsItsEnd) {
  stream_.HalfClose();
  ExpectGoodEnd();
}

}  // namespace
}  // namespace arap::testing
