// Which answers a stream may get.
#include <gtest/gtest.h>

#include "arap/v1/deformation_service.pb.h"
#include "client/src/awaited.h"

namespace arap::client::internal {
namespace {

using Time = AwaitedAnswers::Time;

v1::StreamDeformRequest Update(std::uint64_t sequence, int picks = 0) {
  v1::StreamDeformRequest request;
  request.mutable_update()->set_sequence(sequence);
  request.mutable_update()->mutable_pick_points()->Resize(2 * picks, 0);
  return request;
}

Time At(int seconds) { return Time(std::chrono::seconds(seconds)); }

TEST(AwaitedAnswers, OfEveryUpdateComeInTheirOrder) {
  AwaitedAnswers awaited(true);
  EXPECT_FALSE(awaited.Take(0));
  EXPECT_FALSE(awaited.oldest());
  awaited.Sent(Update(1, 3), At(5));
  awaited.Sent(Update(2), At(6));
  EXPECT_FALSE(awaited.Take(2));
  EXPECT_EQ(awaited.oldest(), At(5));
  EXPECT_EQ(awaited.Take(1).value().picks, 3u);
  EXPECT_EQ(awaited.oldest(), At(6));
  EXPECT_EQ(awaited.Take(2).value().picks, 0u);
  EXPECT_FALSE(awaited.Take(2)) << "once";
}

TEST(AwaitedAnswers, OfTheLatestLeaveOthersOut) {
  AwaitedAnswers awaited(false);
  for (const std::uint64_t sequence : {4u, 5u, 6u}) awaited.Sent(Update(sequence), At(0));
  EXPECT_TRUE(awaited.Take(5));
  EXPECT_FALSE(awaited.Take(4));
  EXPECT_TRUE(awaited.Take(6));
}

TEST(AwaitedAnswers, SequencesNeedNotGrow) {
  AwaitedAnswers awaited(false);
  for (int i = 0; i < 3; ++i) awaited.Sent(Update(0), At(i));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(awaited.Take(0)) << i;
  EXPECT_FALSE(awaited.Take(0));
}

TEST(AwaitedAnswers, AreFewAlsoWhenNobodyReads) {
  constexpr std::uint64_t kSent = 100'000;
  AwaitedAnswers awaited(false);
  for (std::uint64_t i = 1; i <= kSent; ++i) awaited.Sent(Update(i, 1), At(0));
  const auto old = awaited.Take(1);
  ASSERT_TRUE(old);
  EXPECT_FALSE(old->picks) << "how many picks is not known any more";
  EXPECT_TRUE(awaited.Take(2));
  EXPECT_EQ(awaited.Take(kSent).value().picks, 1u);
  EXPECT_FALSE(awaited.Take(2));
  EXPECT_FALSE(awaited.oldest());
}

TEST(AwaitedAnswers, AreMeasuredWhereThatWasAskedOrTakesSuchAPlace) {
  const auto asking = [](std::uint64_t sequence) {
    v1::StreamDeformRequest request = Update(sequence);
    request.mutable_update()->set_measure(true);
    return request;
  };
  v1::StreamDeformRequest edit;
  edit.mutable_edit()->set_sequence(6);
  AwaitedAnswers awaited(false);
  for (const auto& request : {Update(1), asking(2), asking(3), Update(4), Update(5), edit}) {
    awaited.Sent(request, At(0));
  }
  EXPECT_FALSE(awaited.Take(1)->measured);
  EXPECT_TRUE(awaited.Take(2)->measured);
  EXPECT_TRUE(awaited.Take(4)->measured) << "in the place of 3";
  EXPECT_FALSE(awaited.Take(5)->measured);
  EXPECT_TRUE(awaited.Take(6)->measured) << "of an edit";
}

TEST(AwaitedAnswers, OfANewCallAreThoseThatAreSaidAgain) {
  AwaitedAnswers awaited(true);
  awaited.Sent(Update(1), At(0));
  awaited.Sent(Update(2), At(0));
  const std::vector<v1::StreamDeformRequest> again{Update(1), Update(2, 2)};
  awaited.Restart(again, At(9));
  EXPECT_EQ(awaited.oldest(), At(9));
  EXPECT_TRUE(awaited.Take(1));
  EXPECT_EQ(awaited.Take(2).value().picks, 2u);
}

}  // namespace
}  // namespace arap::client::internal
