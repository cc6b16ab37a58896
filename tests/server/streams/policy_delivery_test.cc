// How a live stream opens, and what LATEST and EVERY deliver. stream_policy.h states the rules.
#include <gtest/gtest.h>

#include "tests/server/streams/policy_fixture.h"

namespace arap::testing {
namespace {

using app::StreamMessage;
using Kind = app::StreamAnswer::Kind;
using Lane = app::StreamJob::Lane;
using Work = app::StreamJob::Work;

Fault Numerical() { return Fault(FaultKind::kNumerical, "There is no finite shape."); }

INSTANTIATE_TEST_SUITE_P(Both, DeliveryTest, ::testing::Bool(), [](const auto& each) {
  return std::string(each.param == kLatest ? "Latest" : "Every");
});

// Opening.

TEST_F(PolicyTest, ReadsFirst) {
  EXPECT_TRUE(stream_.reading);
  EXPECT_FALSE(stream_.job || stream_.writing || stream_.finished);
}

TEST_F(PolicyTest, FirstMessageMustOpen) {
  const decltype(StreamMessage::payload) others[] = {StreamMessage::Update{}, StreamMessage::Edit{},
                                                     StreamMessage::Ping{}, std::monostate()};
  for (const auto& other : others) {
    PolicyDriver stream;
    stream.Send(other);
    ASSERT_TRUE(stream.finished.has_value());
    EXPECT_EQ(stream.finished->error().kind, FaultKind::kProtocol);
    EXPECT_EQ(stream.broken, "");
  }
  stream_.HalfClose();
  ExpectEnd(FaultKind::kProtocol);
}

TEST_F(PolicyTest, OpensOnTheLaneThatMayWait) {
  stream_.Open();
  ASSERT_TRUE(stream_.job.has_value());
  EXPECT_EQ(stream_.job->work, Work::kOpen);
  EXPECT_EQ(stream_.job->lane, Lane::kControl);
  EXPECT_TRUE(stream_.reading) << "the next message may come meanwhile";
  stream_.FinishJob();
  ASSERT_TRUE(stream_.writing.has_value());
  EXPECT_EQ(stream_.writing->kind, Kind::kOpened);
}

TEST_F(PolicyTest, NothingIsTakenWhileItOpens) {
  stream_.Open();
  stream_.Update(1, {At("a", 1, 1)});
  EXPECT_FALSE(stream_.reading);
  stream_.FinishJob();
  EXPECT_TRUE(stream_.reading);
  ExpectUpdateJob(1);
}

TEST_F(PolicyTest, OpenThatFailsEndsTheStream) {
  stream_.Open();
  stream_.FailJob(Fault(FaultKind::kNotFound, "There is no session."));
  ExpectEnd(FaultKind::kNotFound);
}

TEST_F(PolicyTest, OpenWithoutRoomEndsTheStream) {
  stream_.no_room = true;
  stream_.Open();
  ExpectEnd(FaultKind::kOverloaded);
}

TEST_F(PolicyTest, OpenIsAdmittedByTheLoadOfItsFrames) {
  stream_.too_busy = Fault(FaultKind::kLimitExceeded, "Too busy.");
  stream_.Open();
  stream_.FinishJob();
  ExpectEnd(FaultKind::kLimitExceeded);
  ASSERT_EQ(stream_.asked.size(), 1u);
  EXPECT_EQ(stream_.asked[0].first, "open");
  EXPECT_NEAR(stream_.asked[0].second, 0.03, 1e-9) << "frames of a millisecond, thirty a second";
}

TEST_P(DeliveryTest, SecondOpenEndsTheStream) {
  stream_.Open();
  ExpectEnd(FaultKind::kProtocol);
}

TEST_P(DeliveryTest, EmptyMessageEndsTheStream) {
  stream_.Send(std::monostate());
  ExpectEnd(FaultKind::kProtocol);
}

TEST_P(DeliveryTest, MessageThatIsTooLargeEndsTheStream) {
  const std::size_t most = stream_.limits.max_message_bytes;
  stream_.Send(StreamMessage::Ping{1}, most);
  ExpectPong(1);
  stream_.Send(StreamMessage::Ping{1}, most + 1);
  ExpectEnd(FaultKind::kLimitExceeded);
}

// LATEST.

TEST_F(PolicyTest, LatestStartsTheNewestAndCountsTheReplaced) {
  stream_.OpenAndAnswer(kLatest);
  stream_.Update(1);
  ExpectUpdateJob(1);
  for (std::uint64_t i = 2; i <= 5; ++i) stream_.Update(i);
  EXPECT_TRUE(stream_.reading) << "LATEST takes all that come";
  stream_.FinishJob();
  ExpectUpdateJob(5);
  ExpectShape(1);
  stream_.FinishJob();
  ExpectShape(5, 3);
}

TEST_F(PolicyTest, LatestKeepsTheTargetsOfReplacedUpdates) {
  stream_.OpenAndAnswer(kLatest);
  stream_.Update(1);
  EXPECT_EQ(stream_.job->targets[1].position, Complex(4, 0)) << "where it rests";
  stream_.Update(2, {At("a", 5, 0)});
  stream_.Update(3, {At("b", 9, 0)});
  EXPECT_EQ(stream_.job->targets[0].position, Complex(0, 0)) << "what runs stays as it is";
  stream_.FinishJob();
  ExpectUpdateJob(3);
  EXPECT_EQ(stream_.job->targets[0].position, Complex(5, 0));
  EXPECT_EQ(stream_.job->targets[1].position, Complex(9, 0));
  EXPECT_EQ(stream_.job->targets[2].position, Complex(0, 4));
}

TEST_F(PolicyTest, LatestReplacesTheShapeThatWaits) {
  stream_.OpenAndAnswer(kLatest);
  stream_.Update(1);
  stream_.FinishJob();  // being written
  stream_.Update(2);
  stream_.FinishJob();  // waits
  stream_.Update(3);
  ExpectUpdateJob(3);
  stream_.Update(4);
  stream_.Update(5);
  stream_.FinishJob();  // takes the place of 2
  ExpectUpdateJob(5);
  ExpectShape(1);
  ExpectShape(3, 1);
  stream_.FinishJob();
  ExpectShape(5, 1);
  EXPECT_EQ(stream_.policy.counts().shapes, 3u);
  EXPECT_EQ(stream_.policy.counts().replaced, 2u);
}

TEST_F(PolicyTest, WhatAFailedUpdateHadReplacedIsCountedByTheNextShape) {
  stream_.OpenAndAnswer(kLatest);
  stream_.Update(1);
  stream_.Update(2);
  stream_.Update(3);
  stream_.FinishJob();
  ExpectShape(1);
  ExpectUpdateJob(3);
  stream_.FailJob(Numerical());
  ExpectError(3, FaultKind::kNumerical);
  stream_.Update(4);
  stream_.FinishJob();
  ExpectShape(4, 1);
}

// EVERY.

TEST_F(PolicyTest, EveryAnswersEachInOrder) {
  stream_.OpenAndAnswer(kEvery);
  stream_.Update(1, {At("a", 1, 0)});
  stream_.Update(2, {At("a", 2, 0)});
  EXPECT_TRUE(stream_.reading);
  stream_.Update(3, {At("a", 3, 0)});
  EXPECT_FALSE(stream_.reading) << "one runs, one waits, one is held";
  for (std::uint64_t i = 1; i <= 3; ++i) {
    ExpectUpdateJob(i);
    EXPECT_EQ(stream_.job->targets[0].position, Complex(static_cast<double>(i), 0));
    stream_.FinishJob();
    ExpectShape(i);
  }
  EXPECT_TRUE(stream_.reading);
}

TEST_F(PolicyTest, EveryStartsNothingWhileAnAnswerWaits) {
  stream_.OpenAndAnswer(kEvery);
  stream_.Update(1);
  stream_.FinishJob();
  stream_.Update(2);
  stream_.FinishJob();
  stream_.Update(3);
  EXPECT_FALSE(stream_.job.has_value()) << "1 is being written, 2 waits";
  ExpectShape(1);
  ExpectUpdateJob(3);
  ExpectShape(2);
}

}  // namespace
}  // namespace arap::testing
