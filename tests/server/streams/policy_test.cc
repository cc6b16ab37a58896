// The rules of a live stream, one by one. stream_policy.h states them.
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "core/base/mutex.h"
#include "server/runtime/worker_pool.h"
#include "server/streams/stream_policy.h"
#include "tests/server/streams/policy_driver.h"
#include "tests/support/random.h"

namespace arap::testing {
namespace {

using app::StreamMessage;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Kind = app::StreamAnswer::Kind;
using Lane = app::StreamJob::Lane;
using Work = app::StreamJob::Work;

constexpr bool kLatest = true;
constexpr bool kEvery = false;

app::NamedTarget At(const char* id, double x, double y) { return {id, {{x, y}, 0, 1}}; }

Fault Numerical() { return Fault(FaultKind::kNumerical, "There is no finite shape."); }

// The tests of both deliveries take it as their parameter.
class PolicyTest : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(stream_.broken, ""); }

  void ExpectEnd(FaultKind kind) {
    ASSERT_TRUE(stream_.finished.has_value()) << "the stream goes on";
    ASSERT_FALSE(stream_.finished->has_value()) << "the stream has ended well";
    EXPECT_EQ(stream_.finished->error().kind, kind) << stream_.finished->error().message;
  }
  void ExpectGoodEnd() {
    ASSERT_TRUE(stream_.finished.has_value()) << "the stream goes on";
    EXPECT_TRUE(stream_.finished->has_value()) << stream_.finished->error().message;
  }
  // The answer that is being written, and the end of the write.
  void ExpectShape(std::uint64_t sequence, std::uint64_t replaced = 0) {
    ASSERT_TRUE(stream_.writing.has_value()) << "no answer to " << sequence;
    EXPECT_EQ(stream_.writing->kind, Kind::kShape);
    EXPECT_EQ(stream_.writing->sequence, sequence);
    EXPECT_EQ(stream_.writing->replaced, replaced);
    stream_.FinishWrite();
  }
  void ExpectError(std::uint64_t sequence, FaultKind kind, const std::string& field = {}) {
    ASSERT_TRUE(stream_.writing.has_value()) << "no answer to " << sequence;
    ASSERT_EQ(stream_.writing->kind, Kind::kError);
    EXPECT_EQ(stream_.writing->sequence, sequence);
    EXPECT_EQ(stream_.writing->fault->kind, kind) << stream_.writing->fault->message;
    if (!field.empty()) {
      EXPECT_EQ(stream_.writing->fault->field, field);
    }
    stream_.FinishWrite();
  }
  void ExpectPong(std::uint64_t nonce) {
    ASSERT_TRUE(stream_.writing.has_value());
    EXPECT_EQ(stream_.writing->kind, Kind::kPong);
    EXPECT_EQ(stream_.writing->nonce, nonce);
    stream_.FinishWrite();
  }
  // The job that runs is the update of this number.
  void ExpectUpdateJob(std::uint64_t sequence) {
    ASSERT_TRUE(stream_.job.has_value()) << "update " << sequence << " has not started";
    EXPECT_EQ(stream_.job->work, Work::kUpdate);
    EXPECT_EQ(stream_.job->lane, Lane::kFrames);
    EXPECT_EQ(stream_.job->sequence, sequence);
  }

  PolicyDriver stream_;
};

class DeliveryTest : public PolicyTest, public ::testing::WithParamInterface<bool> {
 protected:
  void SetUp() override { stream_.OpenAndAnswer(GetParam()); }
};
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
  ASSERT_EQ(stream_.shares.size(), 1u);
  EXPECT_NEAR(stream_.shares[0], 0.06, 1e-9) << "frames of a millisecond, sixty a second";
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

// Updates.

TEST_P(DeliveryTest, UpdateMovesSomeHandles) {
  stream_.Update(1, {At("c", 7, 8)});
  ExpectUpdateJob(1);
  EXPECT_EQ(stream_.job->targets[0].position, Complex(0, 0));
  EXPECT_EQ(stream_.job->targets[2].position, Complex(7, 8));
}

TEST_P(DeliveryTest, PackedPositionsMoveAllAndLeaveAngles) {
  stream_.Update(1, {app::NamedTarget{"b", {{4, 0}, 0.5, 2}}});
  stream_.FinishJob();
  ExpectShape(1);
  stream_.Packed(2, {1, 2, 3, 4, 5, 6});
  ExpectUpdateJob(2);
  EXPECT_EQ(stream_.job->targets[0].position, Complex(1, 2));
  EXPECT_EQ(stream_.job->targets[1].position, Complex(3, 4));
  EXPECT_EQ(stream_.job->targets[1].angle, 0.5);
  EXPECT_EQ(stream_.job->targets[1].scale, 2);
}

TEST_P(DeliveryTest, BadUpdatesAreAnsweredAndMoveNothing) {
  const double nan = std::nan("");
  stream_.Update(1, {At("a", 9, 9), At("nobody", 0, 0)});
  ExpectError(1, FaultKind::kUnknownHandle, "targets[1].handle_id");
  stream_.Update(2, {At("a", 9, 9), At("a", 8, 8)});
  ExpectError(2, FaultKind::kDuplicateHandle);
  stream_.Update(3, {At("a", 9, nan)});
  ExpectError(3, FaultKind::kNonFiniteTarget);
  stream_.Packed(4, {1, 2, 3, 4, 5});
  ExpectError(4, FaultKind::kTargetCount, "positions");
  stream_.Packed(5, {1, 2, 3, 4, 5, nan});
  ExpectError(5, FaultKind::kNonFiniteTarget);
  static constexpr double kPositions[] = {1, 2, 3, 4, 5, 6};
  stream_.Send(StreamMessage::Update{6, {At("a", 9, 9)}, kPositions, {}});
  ExpectError(6, FaultKind::kInvalidOption, "positions");
  stream_.Send(StreamMessage::Update{
      7, {At("a", 9, 9)}, {}, Fail(FaultKind::kArrayLength, "An odd number.")});
  ExpectError(7, FaultKind::kArrayLength);
  EXPECT_EQ(stream_.policy.counts().errors, 7u);
  stream_.Update(8);
  EXPECT_EQ(stream_.job->targets[0].position, Complex(0, 0));
}

TEST_P(DeliveryTest, RefusalsKeepTheirPlaceAmongTheAnswers) {
  stream_.Update(1, {At("a", 1, 0)});
  stream_.Update(2, {At("nobody", 0, 0)});
  EXPECT_FALSE(stream_.reading) << "held until 1 is answered";
  EXPECT_FALSE(stream_.writing.has_value());
  stream_.FinishJob();
  ExpectShape(1);
  ExpectError(2, FaultKind::kUnknownHandle);
  EXPECT_TRUE(stream_.reading);
}

TEST_P(DeliveryTest, ContradictingHardHandlesAreRefusedBeforeTheyStart) {
  Handle p, q;
  p.id = "p";
  q.id = "q";
  p.anchor = q.anchor = VertexAnchor{6};
  p.hard = q.hard = true;
  PolicyDriver stream;
  stream.set = *CompiledHandles::Compile(ThreeCorners()->mesh(), {p, q});
  stream.OpenAndAnswer(GetParam());
  stream.Update(1, {At("p", 5, 1)});
  ASSERT_TRUE(stream.writing && stream.writing->fault);
  EXPECT_EQ(stream.writing->fault->kind, FaultKind::kConflictingHandles);
  stream.FinishWrite();
  stream.Packed(2, {5, 1, 5, 1});
  EXPECT_TRUE(stream.job.has_value());
  EXPECT_EQ(stream.broken, "");
}

// Each is found by its id in the index of the set; core/deform has the test of how few comparisons
// that takes.
TEST_P(DeliveryTest, AThousandHandlesMayComeInAnyOrder) {
  constexpr std::uint32_t kHandles = 1'000;
  std::vector<Handle> handles(kHandles);
  for (std::uint32_t i = 0; i < kHandles; ++i) {
    handles[i].id = "handle_" + std::to_string(i);
    handles[i].anchor = VertexAnchor{i % 25};
  }
  PolicyDriver stream;
  stream.set = *CompiledHandles::Compile(ThreeCorners()->mesh(), handles);
  stream.OpenAndAnswer(GetParam());
  std::vector<app::NamedTarget> targets;
  for (std::uint32_t i = kHandles; i-- > 0;)
    targets.push_back({handles[i].id, {{1. * i, 0}, 0, 1}});
  stream.Update(1, targets);
  ASSERT_TRUE(stream.job.has_value());
  for (std::uint32_t i = 0; i < kHandles; ++i) {
    ASSERT_EQ(stream.job->targets[i].position, Complex(i, 0)) << i;
  }
}

TEST_P(DeliveryTest, PicksComeWithTheirUpdate) {
  stream_.Update(1, {}, {{1, 2}, {3, 4}});
  EXPECT_EQ(stream_.job->picks, (std::vector<Complex>{{1, 2}, {3, 4}}));
  stream_.FinishJob();
  stream_.Update(2);
  EXPECT_TRUE(stream_.job->picks.empty());
}

TEST_P(DeliveryTest, UpdateWithoutRoomIsAnswered) {
  stream_.no_room = true;
  stream_.Update(1);
  ExpectError(1, FaultKind::kOverloaded);
  stream_.no_room = false;
  stream_.Update(2);
  ExpectUpdateJob(2);
}

// Edits.

TEST_P(DeliveryTest, EditWaitsForTheAnswersBeforeIt) {
  stream_.Update(1);
  stream_.Edit(2);
  EXPECT_FALSE(stream_.reading);
  stream_.FinishJob();  // 1 is being written
  ASSERT_TRUE(stream_.job.has_value());
  EXPECT_EQ(stream_.job->work, Work::kEdit);
  EXPECT_EQ(stream_.job->sequence, 2u);
  ExpectShape(1);
  stream_.FinishJob();
  ExpectShape(2);
}

TEST_P(DeliveryTest, EditChangesTheSetAndNothingIsTakenMeanwhile) {
  stream_.Update(1, {At("a", 9, 9)});
  stream_.FinishJob();
  ExpectShape(1);
  stream_.Edit(2);
  EXPECT_EQ(stream_.job->targets[0].position, Complex(9, 9)) << "the last targets";
  stream_.Update(3, {At("d", 6, 6)});
  EXPECT_FALSE(stream_.reading);
  stream_.FinishJob();
  ExpectShape(2);
  ExpectUpdateJob(3);
  EXPECT_EQ(stream_.job->targets[2].position, Complex(6, 6));
  stream_.FinishJob();
  ExpectShape(3);
  stream_.Update(4, {At("b", 0, 0)});
  ExpectError(4, FaultKind::kUnknownHandle);
}

TEST_P(DeliveryTest, FewHandlesWithoutAreasAreLight) {
  stream_.Edit(1, 4);
  EXPECT_EQ(stream_.job->lane, Lane::kFrames);
  stream_.FinishJob();
  ExpectShape(1);
  stream_.Edit(2, 5);
  EXPECT_EQ(stream_.job->lane, Lane::kJobs);
  stream_.FinishJob();
  ExpectShape(2);
  stream_.Edit(3, 1, true);
  EXPECT_EQ(stream_.job->lane, Lane::kJobs);
}

TEST_P(DeliveryTest, EditThatFailsIsAnsweredAndChangesNothing) {
  stream_.Edit(1);
  stream_.FailJob(Fault(FaultKind::kUnknownHandle, "There is no such handle."));
  ExpectError(1, FaultKind::kUnknownHandle);
  stream_.no_room = true;
  stream_.Edit(2);
  ExpectError(2, FaultKind::kOverloaded);
  stream_.no_room = false;
  stream_.Update(3, {At("b", 5, 0)});
  ExpectUpdateJob(3);
}

TEST_F(PolicyTest, ShapeOfAnEditIsNotReplaced) {
  stream_.OpenAndAnswer(kLatest);
  stream_.Update(1);
  stream_.FinishJob();  // being written
  stream_.Edit(2);
  stream_.FinishJob();  // waits
  stream_.Update(3);
  EXPECT_FALSE(stream_.job.has_value());
  ExpectShape(1);
  ExpectUpdateJob(3);
  ExpectShape(2);
}

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
  ASSERT_EQ(stream_.shares.size(), 1u) << "when it opened";
  stream_.Update(1);
  stream_.FinishJob();
  ExpectShape(1);
  EXPECT_EQ(stream_.shares.size(), 1u) << "awake";
  stream_.Advance(app::LoadGuard::kWindow);
  stream_.too_busy = Fault(FaultKind::kLimitExceeded, "Too busy.");
  stream_.Update(2);
  ExpectError(2, FaultKind::kLimitExceeded);
  EXPECT_EQ(stream_.shares.size(), 2u);
  stream_.too_busy.reset();
  stream_.Update(3);
  ExpectUpdateJob(3);
  EXPECT_EQ(stream_.shares.size(), 3u);
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

// Everything at once.

TEST(PolicyPropertyTest, AnyEventsKeepThePromises) {
  Random random(11);
  for (int run = 0; run < 3'000; ++run) {
    std::vector<std::uint8_t> bytes(random.Below(400));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random.Below(256));
    if (!bytes.empty() && run % 4 != 0) bytes[1 % bytes.size()] |= 1u;  // most of them open
    ASSERT_EQ(DrivePolicy(bytes.data(), bytes.size()), "") << "run " << run;
  }
}

// A policy under a lock, with reads, writes, jobs and sweeps on threads of their own, as a reactor
// has it. ThreadSanitizer watches.
class BusyStream {
 public:
  BusyStream(bool latest, std::uint64_t updates) : latest_(latest), updates_(updates) {
    const MutexLock lock(&mutex_);
    Pump();
  }

  // Until it has finished, or for a minute.
  bool Wait() {
    const auto deadline = std::chrono::steady_clock::now() + seconds(60);
    const MutexLock lock(&mutex_);
    while (!finished_) {
      if (changed_.WaitUntil(&mutex_, deadline)) return false;
    }
    return true;
  }

  void Sweep() {
    const MutexLock lock(&mutex_);
    EXPECT_FALSE(policy_.Sweep(clock_.SteadyNow()));
    Pump();
  }

  void Stop() {
    wire_.Stop();
    workers_.Stop();
  }

  std::uint64_t answered() {
    const MutexLock lock(&mutex_);
    return answered_;
  }

 private:
  void Pump() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    for (;;) {
      app::StreamStep step = policy_.Next();
      if (std::holds_alternative<std::monostate>(step)) return;
      if (std::holds_alternative<app::StreamRead>(step)) {
        ASSERT_TRUE(wire_.TryPost([this] { Read(); }));
      } else if (auto* job = std::get_if<app::StreamJob>(&step)) {
        job_ = std::move(*job);
        ASSERT_TRUE(workers_.TryPost([this] { Run(); }));
      } else if (auto* write = std::get_if<app::StreamWrite>(&step)) {
        const auto kind = write->answer.kind;
        if (kind == Kind::kShape || kind == Kind::kError) answered_ += write->answer.replaced + 1;
        ASSERT_TRUE(wire_.TryPost([this] { Written(); }));
      } else {
        finished_ = true;
        changed_.SignalAll();
      }
    }
  }

  void Read() {
    const MutexLock lock(&mutex_);
    if (!opened_) {
      opened_ = true;
      policy_.MessageRead({10, StreamMessage::Open{}});
    } else if (sent_ < updates_) {
      ++sent_;
      policy_.MessageRead(
          {10, StreamMessage::Update{sent_, {At("a", static_cast<double>(sent_), 0)}, {}, {}}});
    } else {
      policy_.HalfClosed();
    }
    Pump();
  }

  void Written() {
    const MutexLock lock(&mutex_);
    policy_.Written(true);
    Pump();
  }

  void Run() {
    // The targets are the job's: no lock.
    double sum = 0;
    for (const Target& target : job_.targets) sum += target.position.real();
    EXPECT_TRUE(std::isfinite(sum));
    const auto set = ThreeCorners();
    const MutexLock lock(&mutex_);
    if (job_.work == Work::kOpen) {
      EXPECT_TRUE(policy_.AdmitFrames(1e-3));
      policy_.Opened(
          {set, set->RestTargets()}, latest_, [] { return Status(); },
          std::make_unique<app::WireAnswer>());
    } else {
      policy_.Moved(std::make_unique<app::WireAnswer>());
    }
    Pump();
  }

  const Limits limits_{};
  const runtime::FakeClock clock_{};
  const bool latest_;
  const std::uint64_t updates_;

  Mutex mutex_;
  CondVar changed_;
  app::StreamPolicy policy_ ABSL_GUARDED_BY(mutex_){limits_, clock_,
                                                    [](double) { return Status(); }};
  bool opened_ ABSL_GUARDED_BY(mutex_) = false;
  std::uint64_t sent_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t answered_ ABSL_GUARDED_BY(mutex_) = 0;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  app::StreamJob job_;  // the running job's
  runtime::WorkerPool wire_{2, 16};
  runtime::WorkerPool workers_{2, 16};
};

TEST(PolicyThreadsTest, ReadsWritesJobsAndSweepsSideBySide) {
  for (const bool latest : {kLatest, kEvery}) {
    constexpr std::uint64_t kUpdates = 2'000;
    BusyStream stream(latest, kUpdates);
    std::atomic<bool> over = false;
    std::thread sweeper([&] {
      for (int i = 0; i < 20'000 && !over; ++i) stream.Sweep();
    });
    EXPECT_TRUE(stream.Wait()) << "the stream did not finish in time";
    over = true;
    sweeper.join();
    stream.Stop();
    EXPECT_EQ(stream.answered(), kUpdates);
  }
}

}  // namespace
}  // namespace arap::testing
