// What a stream that is resumed says again.
#include "client/src/replay_log.h"

#include <gmock/gmock.h>

namespace arap::client::internal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

v1::StreamDeformRequest Move(std::uint64_t sequence, const std::string& id, double x,
                             double angle = 0) {
  v1::StreamDeformRequest request;
  request.mutable_update()->set_sequence(sequence);
  v1::HandleTarget& target = *request.mutable_update()->add_targets();
  target.set_handle_id(id);
  target.set_x(x);
  target.set_angle_radians(angle);
  return request;
}

v1::StreamDeformRequest Place(std::uint64_t sequence, const std::vector<double>& positions) {
  v1::StreamDeformRequest request;
  request.mutable_update()->set_sequence(sequence);
  request.mutable_update()->mutable_positions()->Add(positions.begin(), positions.end());
  return request;
}

v1::StreamDeformRequest Remove(std::uint64_t sequence, const std::string& id) {
  v1::StreamDeformRequest request;
  request.mutable_edit()->set_sequence(sequence);
  request.mutable_edit()->add_remove(id);
  return request;
}

// "2 a=1 b=3", "2 0 0 8 0", "3 -a".
std::string Brief(const v1::StreamDeformRequest& request) {
  std::ostringstream text;
  if (request.has_edit()) {
    text << request.edit().sequence() << " -" << request.edit().remove(0);
    return text.str();
  }
  text << request.update().sequence();
  for (const auto& target : request.update().targets()) {
    text << ' ' << target.handle_id() << '=' << target.x();
    if (target.angle_radians() != 0) text << '@' << target.angle_radians();
  }
  for (const double x : request.update().positions()) text << ' ' << x;
  return text.str();
}

std::vector<std::string> Said(const ReplayLog& log) {
  std::vector<std::string> said;
  for (const auto& message : log.Messages()) said.push_back(Brief(message));
  return said;
}

TEST(ReplayLogTest, SaysTheLastTargetOfEveryHandleAndWhatHasNoAnswer) {
  ReplayLog log(false);
  EXPECT_THAT(Said(log), IsEmpty());
  log.Sent(Move(1, "a", 1));
  log.Sent(Move(2, "b", 2));
  log.Sent(Move(3, "a", 3));
  log.Sent(Move(4, "a", 4));
  log.Sent(Move(5, "b", 5));
  EXPECT_TRUE(log.Answered(1, true));
  EXPECT_TRUE(log.Answered(2, true));
  EXPECT_TRUE(log.Answered(3, true));
  EXPECT_THAT(Said(log), ElementsAre("3 a=3 b=2", "4 a=4", "5 b=5"));
  EXPECT_FALSE(log.Answered(3, true)) << "said again, answered again";
  EXPECT_THAT(Said(log), ElementsAre("3 a=3 b=2", "4 a=4", "5 b=5"));
}

TEST(ReplayLogTest, AnAnswerStandsForTheUpdatesThatItReplaced) {
  ReplayLog log(true);
  for (std::uint64_t i = 1; i <= 4; ++i)
    log.Sent(Move(i, i % 2 == 0 ? "b" : "a", 10 * static_cast<double>(i)));
  EXPECT_TRUE(log.Answered(3, true));
  EXPECT_THAT(Said(log), ElementsAre("3 a=30 b=20", "4 b=40"));
}

TEST(ReplayLogTest, WhatWasRefusedIsForgotten) {
  ReplayLog log(true);
  log.Sent(Move(1, "a", 1));
  log.Sent(Move(2, "nobody", 2));
  log.Sent(Remove(3, "nobody"));
  log.Sent(Move(4, "a", 4));
  EXPECT_TRUE(log.Answered(2, false));
  EXPECT_TRUE(log.Answered(3, false));
  EXPECT_THAT(Said(log), ElementsAre("1 a=1", "4 a=4"));
}

// Handles that an edit adds start where the shape of that moment has them.
TEST(ReplayLogTest, TargetsBeforeAnEditAreSaidBeforeIt) {
  ReplayLog log(true);
  log.Sent(Move(1, "a", 1));
  log.Sent(Remove(2, "b"));
  log.Sent(Move(3, "a", 3));
  log.Sent(Remove(4, "c"));
  EXPECT_TRUE(log.Answered(2, true));
  EXPECT_TRUE(log.Answered(3, true));
  EXPECT_THAT(Said(log), ElementsAre("1 a=1", "2 -b", "3 a=3", "4 -c"));
  EXPECT_TRUE(log.Answered(4, true));
  EXPECT_THAT(Said(log), ElementsAre("1 a=1", "2 -b", "3 a=3", "4 -c"));
}

TEST(ReplayLogTest, PositionsLeaveAnglesAsTheyAre) {
  ReplayLog log(false);
  log.Sent(Move(1, "a", 1, 0.5));
  log.Sent(Place(2, {7, 0, 8, 0}));
  log.Sent(Move(3, "b", 3));
  for (std::uint64_t i = 1; i <= 3; ++i) EXPECT_TRUE(log.Answered(i, true));
  EXPECT_THAT(Said(log), ElementsAre("1 a=1@0.5", "2 7 0 8 0", "3 b=3"));
  log.Sent(Place(4, {9, 0, 9, 0}));
  EXPECT_TRUE(log.Answered(4, true));
  EXPECT_THAT(Said(log), ElementsAre("3 a=1@0.5 b=3", "4 9 0 9 0"));
}

TEST(ReplayLogTest, LatestMakesOneOfManyUpdatesWithoutAnAnswer) {
  ReplayLog latest(true), every(false);
  const std::uint64_t count = 3 * ReplayLog::kMostPending;
  for (std::uint64_t i = 1; i <= count; ++i) {
    const auto update = Move(i, i % 2 == 0 ? "b" : "a", static_cast<double>(i));
    EXPECT_TRUE(latest.Sent(update));
    EXPECT_TRUE(every.Sent(update));
    EXPECT_LE(Said(latest).size(), ReplayLog::kMostPending);
  }
  EXPECT_EQ(Said(latest).back(), "768 b=768");
  EXPECT_EQ(Said(every).size(), count) << "each is answered";
  // An answer to one of those that were made one leaves what is newer.
  EXPECT_TRUE(latest.Answered(2, true));
  EXPECT_EQ(Said(latest).back(), "768 b=768");
  EXPECT_TRUE(latest.Answered(count, true));
  EXPECT_THAT(Said(latest), ElementsAre("768 a=767 b=768"));
}

TEST(ReplayLogTest, WhatIsMadeOneAsksForMeasuresWhenOneOfThemDid) {
  ReplayLog log(true);
  for (std::uint64_t i = 1; i <= ReplayLog::kMostPending + 1; ++i) {
    auto update = Move(i, "a", static_cast<double>(i));
    update.mutable_update()->set_measure(i == 7);
    EXPECT_TRUE(log.Sent(update));
  }
  ASSERT_LT(log.Messages().size(), 5u);
  EXPECT_TRUE(log.Messages().back().update().measure());
}

TEST(ReplayLogTest, UpdatesBehindAnEditWithoutAnAnswerDoNotPileUp) {
  ReplayLog log(true);
  EXPECT_TRUE(log.Sent(Move(1, "a", 1)));
  EXPECT_TRUE(log.Sent(Move(2, "b", 2)));
  EXPECT_TRUE(log.Sent(Remove(3, "c")));
  for (std::uint64_t i = 4; i <= 10'000; ++i) {
    EXPECT_TRUE(log.Sent(i % 3 == 0 ? Place(i, {static_cast<double>(i), 0})
                                    : Move(i, "a", static_cast<double>(i), 0.5)));
  }
  const std::vector<std::string> said = Said(log);
  EXPECT_LE(said.size(), ReplayLog::kMostPending);
  ASSERT_GE(said.size(), 5u);
  EXPECT_EQ(said[0], "1 a=1");
  EXPECT_EQ(said[1], "2 b=2") << "the last before the edit is answered";
  EXPECT_EQ(said[2], "3 -c");
  EXPECT_EQ(said.back(), "10000 a=10000@0.5");
  std::uint64_t last = 0;
  for (const auto& message : log.Messages()) {
    EXPECT_GT(SequenceOf(message), last);
    last = SequenceOf(message);
  }
}

TEST(ReplayLogTest, SequencesHaveToGrowAndMayBeginWithZero) {
  ReplayLog log(false);
  EXPECT_TRUE(log.Sent(Move(0, "a", 1)));
  EXPECT_FALSE(log.Sent(Move(0, "a", 2)));
  EXPECT_TRUE(log.Answered(0, true));
  EXPECT_FALSE(log.Answered(0, true));
  EXPECT_TRUE(log.Sent(Move(5, "a", 3)));
  EXPECT_FALSE(log.Sent(Remove(4, "b")));
  EXPECT_THAT(Said(log), ElementsAre("0 a=1", "5 a=3"));
}

}  // namespace
}  // namespace arap::client::internal
