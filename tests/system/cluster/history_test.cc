#include "tests/system/cluster/history.h"

#include <gtest/gtest.h>

namespace arap::cluster {
namespace {

using Handles = std::set<std::string>;
using std::chrono::milliseconds;

Call::Time At(int time) { return Call::Time(milliseconds(time)); }

Call Compile(int begin, int end, const Handles& handles) {
  return {CallKind::kCompile, "h", handles, {}, At(begin), At(end), SetState{handles, 1}};
}
Call Edit(int begin, int end, const std::string& add, const SetState& told, Handles remove = {}) {
  return {CallKind::kEdit, "h", {add}, std::move(remove), At(begin), At(end), told};
}
Call Unanswered(int begin, const std::string& add, Handles remove = {}) {
  return {CallKind::kEdit, "h", {add}, std::move(remove), At(begin), std::nullopt, std::nullopt};
}
Call Read(int begin, int end, const SetState& told) {
  return {CallKind::kRead, "h", {}, {}, At(begin), At(end), told};
}

struct Case {
  const char* name;
  std::vector<Call> calls;
  Verdict verdict;
  std::size_t call = 0;
};

class HistoryTest : public ::testing::TestWithParam<Case> {};

TEST_P(HistoryTest, IsExplainedOrNot) {
  const Judgement judgement = Judge(GetParam().calls);
  EXPECT_EQ(judgement.verdict, GetParam().verdict);
  EXPECT_EQ(judgement.call, GetParam().call);
}

const SetState kFirst{{"a"}, 1}, kSecond{{"a", "b"}, 2}, kThird{{"a", "b", "c"}, 3};

INSTANTIATE_TEST_SUITE_P(
    All, HistoryTest,
    ::testing::Values(
        Case{"Nothing", {}, Verdict::kExplained},
        Case{"OneAfterTheOther",
             {Compile(0, 1, {"a"}), Read(2, 3, kFirst), Edit(4, 5, "b", kSecond),
              Read(6, 7, kSecond)},
             Verdict::kExplained},
        Case{"NoSetBeforeItWasCompiled",
             {{CallKind::kRead, "h", {}, {}, At(0), At(1), std::nullopt}, Compile(2, 3, {"a"})},
             Verdict::kExplained},
        Case{"AReadBesideAnEditSeesEither",
             {Compile(0, 1, {"a"}), Edit(2, 9, "b", kSecond), Read(3, 4, kFirst),
              Read(5, 6, kSecond)},
             Verdict::kExplained},
        Case{"EditsAtOnceComeInSomeOrder",
             {Compile(0, 1, {"a"}), Edit(2, 9, "c", kThird), Edit(3, 8, "b", kSecond)},
             Verdict::kExplained},
        Case{"AStaleRead",
             {Compile(0, 1, {"a"}), Edit(2, 3, "b", kSecond), Read(4, 5, kFirst)},
             Verdict::kWrong,
             2},
        Case{"AStaleReadAfterAnotherHasSeenTheEdit",
             {Compile(0, 1, {"a"}), Edit(2, 9, "b", kSecond), Read(3, 4, kSecond),
              Read(5, 6, kFirst)},
             Verdict::kWrong,
             3},
        Case{"ALostWrite",
             {Compile(0, 1, {"a"}), Edit(2, 3, "b", kSecond), Edit(4, 5, "c", {{"a", "c"}, 2})},
             Verdict::kWrong,
             2},
        Case{"TwoEditsThatDidNotSeeEachOther",
             {Compile(0, 1, {"a"}), Edit(2, 9, "b", kSecond), Edit(3, 8, "c", {{"a", "c"}, 2})},
             Verdict::kWrong,
             1},
        Case{"AnEditDoneTwice",
             {Compile(0, 1, {"a"}), Edit(2, 3, "b", kSecond), Read(4, 5, {{"a", "b"}, 3})},
             Verdict::kWrong,
             2},
        Case{"ASetThatIsGone",
             {Compile(0, 1, {"a"}), {CallKind::kRead, "h", {}, {}, At(2), At(3), std::nullopt}},
             Verdict::kWrong,
             1},
        Case{"WithoutAnAnswerItMayHaveBeenDone",
             {Compile(0, 1, {"a"}), Unanswered(2, "b"), Read(3, 4, kFirst), Read(9, 10, kSecond)},
             Verdict::kExplained},
        Case{"WithoutAnAnswerItMayNeverBeDone",
             {Compile(0, 1, {"a"}), Unanswered(2, "b"), Read(3, 4, kFirst), Read(9, 10, kFirst)},
             Verdict::kExplained},
        Case{"WithoutAnAnswerItIsNotUndone",
             {Compile(0, 1, {"a"}), Unanswered(2, "b"), Read(3, 4, kSecond), Read(9, 10, kFirst)},
             Verdict::kWrong,
             3},
        Case{"WithoutAnAnswerItIsNotDoneBeforeItBegan",
             {Compile(0, 1, {"a"}), Read(2, 3, kSecond), Unanswered(4, "b")},
             Verdict::kWrong,
             1},
        Case{"SetsOfASessionDoNotMix",
             {Compile(0, 1, {"a"}),
              Edit(2, 3, "b", kSecond),
              {CallKind::kCompile, "g", {"a"}, {}, At(4), At(5), kFirst},
              Read(6, 7, kSecond)},
             Verdict::kExplained}),
    [](const ::testing::TestParamInfo<Case>& one) { return std::string(one.param.name); });

TEST(History, ManyUnansweredEditsThatNobodySawCostNothing) {
  std::vector<Call> calls{Compile(0, 1, {"a"})};
  for (int i = 0; i < 100; ++i) {
    calls.push_back(Unanswered(2 + i, "lost" + std::to_string(i), {"a"}));
    calls.push_back(Read(200 + 2 * i, 201 + 2 * i, kFirst));
  }
  EXPECT_EQ(Judge(calls).verdict, Verdict::kExplained);
}

TEST(History, ACallIsDescribedWithItsTimes) {
  EXPECT_EQ(Edit(1203, 1207, "b", kSecond, {"x"}).Describe(At(0)),
            "edit h +b -x [1.203 s, 1.207 s] → revision 2 of {a, b}");
  EXPECT_EQ(Unanswered(5, "b").Describe(At(0)), "edit h +b [0.005 s, no answer]");
}

}  // namespace
}  // namespace arap::cluster
