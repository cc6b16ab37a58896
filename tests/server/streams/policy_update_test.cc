// What updates and edits of a live stream do. stream_policy.h states the rules.
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/server/streams/policy_fixture.h"

namespace arap::testing {
namespace {

using app::StreamMessage;
using Lane = app::StreamJob::Lane;
using Work = app::StreamJob::Work;

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

// Measuring.

// Which shapes of updates from 1 on are measured, each computed and written before the next.
std::string MeasuredOf(PolicyDriver& stream, std::uint64_t first, std::uint64_t last,
                       std::uint64_t asking = 0) {
  std::string measured;
  for (std::uint64_t i = first; i <= last; ++i) {
    StreamMessage::Update update;
    update.sequence = i;
    update.measure = i == asking;
    stream.Send(std::move(update));
    const bool measures = stream.job->measure;
    stream.FinishJob();
    EXPECT_EQ(stream.writing->measured, measures) << i;
    stream.FinishWrite();
    measured += measures ? 'm' : '.';
  }
  return measured;
}

TEST_P(DeliveryTest, TheFirstShapeAndEveryNthAfterAMeasuredOneAreMeasured) {
  const struct {
    std::uint32_t every;
    std::uint64_t asking;
    const char* measured;
  } cases[] = {{1, 0, "mmmmmmm"},   {2, 0, "m.m.m.m"}, {3, 0, "m..m..m"}, {3, 3, "m.m..m."},
               {100, 0, "m......"}, {0, 0, "......."}, {0, 4, "...m..."}};
  for (const auto& [every, asking, measured] : cases) {
    PolicyDriver stream;
    stream.measure_every = every;
    stream.OpenAndAnswer(GetParam());
    EXPECT_EQ(MeasuredOf(stream, 1, 7, asking), measured) << every << ", " << asking;
    EXPECT_EQ(stream.broken, "");
  }
}

TEST_P(DeliveryTest, AnEditIsMeasuredAndCounts) {
  PolicyDriver stream;
  stream.measure_every = 3;
  stream.OpenAndAnswer(GetParam());
  EXPECT_EQ(MeasuredOf(stream, 1, 2), "m.");
  stream.Edit(3);
  stream.FinishJob();
  EXPECT_TRUE(stream.writing->measured);
  stream.FinishWrite();
  EXPECT_EQ(MeasuredOf(stream, 4, 7), "..m.");
}

TEST_P(DeliveryTest, AfterAMeasuredShapeThatFailsTheNextIsMeasured) {
  PolicyDriver stream;
  stream.measure_every = 4;
  stream.OpenAndAnswer(GetParam());
  stream.Update(1);
  EXPECT_TRUE(stream.job->measure);
  stream.FailJob(Fault(FaultKind::kNumerical, "No finite shape."));
  stream.FinishWrite();
  EXPECT_EQ(MeasuredOf(stream, 2, 4), "m..");
}

TEST_F(PolicyTest, WhatTakesThePlaceOfAMeasuredShapeIsMeasured) {
  stream_.measure_every = 100;
  stream_.OpenAndAnswer(kLatest);
  stream_.Update(1);
  stream_.FinishJob();  // measured, being written
  stream_.Send(StreamMessage::Update{2, {}, {}, {}, true});
  stream_.Send(StreamMessage::Update{3, {}, {}, {}, true});  // has not started
  stream_.Update(4);                                         // in its place
  EXPECT_TRUE(stream_.job->measure) << "2 asked";
  stream_.FinishJob();  // 2 waits
  ExpectUpdateJob(4);
  EXPECT_TRUE(stream_.job->measure) << "3 asked, and 2 was measured";
  stream_.FinishJob();  // in the place of 2
  stream_.Update(5);
  EXPECT_TRUE(stream_.job->measure) << "4 waits and is measured";
  ExpectShape(1);
  stream_.FinishJob();
  ExpectShape(4, 2);
  stream_.Update(6);
  EXPECT_FALSE(stream_.job->measure);
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

TEST_P(DeliveryTest, OneHandleOnALargeSetIsAJobWhenItFactorsAnew) {
  PolicyDriver stream;
  stream.set = ManyRows();
  stream.OpenAndAnswer(GetParam());
  stream.Edit(1, 1);
  ASSERT_TRUE(stream.job.has_value());
  EXPECT_EQ(stream.job->lane, Lane::kJobs);
  EXPECT_GT(stream.job->seconds, app::kLongFrameSeconds);
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

}  // namespace
}  // namespace arap::testing
