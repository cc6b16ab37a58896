// When a stream asks for a sign of life, and whose the answers are.
#include <gmock/gmock.h>

#include "client/src/awaited.h"

namespace arap::client::internal {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::Eq;
using testing::Optional;

class SignsOfLifeTest : public testing::Test {
 protected:
  SignsOfLife life{milliseconds(10), milliseconds(50)};
  SignsOfLife::Time start{std::chrono::seconds(100)};
};

TEST_F(SignsOfLifeTest, AsksAfterSilenceAndGivesUpAfterMore) {
  life.Restart(start);
  life.SetWaiting(true, start);
  EXPECT_FALSE(life.IsDue(true, start + milliseconds(9)));
  EXPECT_TRUE(life.IsDue(true, start + milliseconds(10)));
  life.Ask(std::nullopt, true, start + milliseconds(10));
  EXPECT_FALSE(life.IsDue(true, start + milliseconds(30))) << "one question is on its way";
  EXPECT_FALSE(life.IsSilent(start + milliseconds(49)));
  EXPECT_TRUE(life.IsSilent(start + milliseconds(50)));
  life.SetWaiting(false, start + milliseconds(50));
  EXPECT_FALSE(life.IsSilent(start + milliseconds(500))) << "nobody waits";
}

TEST_F(SignsOfLifeTest, GoesOnAskingWhileNobodyReadsAsLongAsItCan) {
  life.Restart(start);
  life.Ask(std::nullopt, true, start);
  EXPECT_TRUE(life.IsDue(true, start + milliseconds(10)));
  EXPECT_FALSE(life.IsDue(false, start + milliseconds(10)));
}

TEST_F(SignsOfLifeTest, AnswersComeInTheOrderOfTheQuestions) {
  life.Ask(7, false, start);             // kept until the call is open
  life.Ask(std::nullopt, false, start);  // goes out at once
  life.Ask(8, true, start);
  EXPECT_THAT(life.Unanswered(), ElementsAre(7, 8));
  EXPECT_THAT(life.Answered(), Eq(std::nullopt));
  EXPECT_THAT(life.Answered(), Optional(7u));
  EXPECT_THAT(life.Answered(), Optional(8u));
  EXPECT_THAT(life.Answered(), Eq(std::nullopt)) << "of a question that nobody has asked";
}

TEST_F(SignsOfLifeTest, ANewCallKnowsTheUsersQuestionsOnly) {
  life.Ask(std::nullopt, true, start);
  life.Ask(7, true, start);
  life.Restart(start);
  EXPECT_THAT(life.Unanswered(), ElementsAre(7));
  EXPECT_THAT(life.Answered(), Optional(7u));
}

}  // namespace
}  // namespace arap::client::internal
