// Whose turn it is: by owner, by stream, by age and length.
#include "server/runtime/fair_queue.h"

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace arap::runtime {
namespace {

using std::chrono::duration;
using std::chrono::duration_cast;
using std::chrono::milliseconds;
using std::chrono::seconds;

// One worker and a clock that its work moves.
class FairQueueTest : public ::testing::Test {
 protected:
  using Queue = FairQueue<std::string>;

  void Push(const std::string& owner, std::uint64_t flow, double expected,
            const std::string& item = {}) {
    queue_.Push({{owner, flow, expected}, now_, item}, true);
  }
  // Works off the next entry, which takes `actual` seconds, and answers it.
  Queue::Entry Work(double actual) {
    auto entry = queue_.Pop();
    EXPECT_TRUE(entry.has_value());
    if (!entry) return {};
    queue_.Charge(entry->share, actual - Queue::Paid(entry->share));
    now_ += duration_cast<milliseconds>(duration<double>(actual));
    served_[entry->share.owner] += actual;
    return *std::move(entry);
  }
  std::string Next(double actual = 0.01) { return Work(actual).item; }

  Queue queue_;
  Queue::Time now_{seconds(1'000)};
  std::map<std::string, double> served_;
};

TEST_F(FairQueueTest, OneOwnersCallsComeInTheirOrder) {
  for (const char* item : {"a", "b", "c"}) {
    Push("ann", 0, 0.01, item);
    now_ += milliseconds(1);
  }
  for (const char* item : {"a", "b", "c"}) EXPECT_EQ(Next(), item);
  EXPECT_FALSE(queue_.Pop().has_value());
}

TEST_F(FairQueueTest, OwnersHaveEqualTimeWhateverTheirWorkTakes) {
  for (int i = 0; i < 500; ++i) {
    Push("ann", 0, 0.01);
    Push("ben", 0, 0.001);
    Push("ben", 1, 0.001);
  }
  while (served_["ann"] < 0.5) Work(queue_.size() % 7 == 0 ? 0.002 : 0.001);
  EXPECT_NEAR(served_["ben"], served_["ann"], 0.02) << "what it took counts, not what was expected";
}

TEST_F(FairQueueTest, ANewcomerIsNext) {
  for (int i = 0; i < 1'000; ++i) Push("ann", static_cast<std::uint64_t>(i % 10), 0.01);
  for (int i = 0; i < 100; ++i) Next();
  Push("ben", 0, 0.01, "ben");
  EXPECT_EQ(Next(), "ben");
  Push("ben", 0, 0.01, "ben again");
  EXPECT_NE(Next(), "ben again") << "ann is next: both had a turn";
  EXPECT_EQ(Next(), "ben again");
}

// A stream has one frame waiting at most, and comes back after each.
TEST_F(FairQueueTest, ADragIsNeverBehindAFloodOfFrames) {
  for (std::uint64_t flow = 1; flow <= 65; ++flow) Push("ann", flow, 0.02);
  Work(0.02);
  for (int frame = 0; frame < 100; ++frame) {
    Push("ben", 1, 0.0005, "drag");
    EXPECT_EQ(Next(0.0005), "drag") << frame;
    for (int i = 0; i < 2; ++i) {
      const auto flood = Work(0.02);
      EXPECT_EQ(flood.share.owner, "ann");
      Push("ann", flood.share.flow, 0.02);
    }
  }
}

TEST_F(FairQueueTest, StreamsOfAnOwnerHaveEqualTime) {
  std::map<std::uint64_t, double> by_flow;
  for (std::uint64_t flow = 1; flow <= 4; ++flow) Push("ann", flow, 0.001);
  for (int i = 0; i < 4'000; ++i) {
    const auto entry = queue_.Pop();
    const double actual = 0.001 * static_cast<double>(entry->share.flow);
    queue_.Charge(entry->share, actual - Queue::Paid(entry->share));
    by_flow[entry->share.flow] += actual;
    Push("ann", entry->share.flow, 0.001);
  }
  for (const auto& [flow, served] : by_flow) EXPECT_NEAR(served, by_flow[1], 0.02) << flow;
}

TEST_F(FairQueueTest, NobodySavesUpTurnsAndDebtsAreForgotten) {
  Push("ben", 0, 0.01);
  Next();
  // Ann has the lane for a minute.
  for (int i = 0; i < 600; ++i) {
    Push("ann", 0, 0.1);
    Next(0.1);
  }
  served_.clear();
  for (int i = 0; i < 100; ++i) {
    Push("ann", 0, 0.1);
    Push("ben", 0, 0.1);
  }
  for (int i = 0; i < 100; ++i) Next(0.1);
  EXPECT_NEAR(served_["ann"], served_["ben"], Queue::kMostDebt + 0.1);
}

TEST_F(FairQueueTest, AnOwnersShortWorkGoesFirstAndItsLongWorkGetsItsTurn) {
  Push("ann", 0, 10, "long");
  int before = 0;
  for (;;) {
    now_ += milliseconds(500);
    Push("ann", 0, 0.1, "short");
    if (Next(0) == "long") break;
    ++before;
    ASSERT_LT(before, 1'000);
  }
  EXPECT_NEAR(before, 80, 2) << "after about four times what it takes";
}

TEST_F(FairQueueTest, TheShortPlaceTakesShortWorkOnlyInTurn) {
  Push("ann", 0, 10, "long");
  Push("ann", 0, 0.01, "ann");
  Push("ben", 0, 0.02, "ben");
  EXPECT_EQ(queue_.Pop(0.05)->item, "ann");
  EXPECT_EQ(queue_.Pop(0.05)->item, "ben");
  EXPECT_FALSE(queue_.Pop(0.05).has_value());
  EXPECT_EQ(queue_.Pop()->item, "long");
}

TEST_F(FairQueueTest, SaysWhoWouldBeNext) {
  EXPECT_TRUE(queue_.WouldBeNext("ann")) << "nobody waits";
  Push("ann", 0, 0.01);
  EXPECT_FALSE(queue_.WouldBeNext("ann")) << "older work of hers";
  EXPECT_FALSE(queue_.WouldBeNext("ben")) << "served as little, and ann has waited for longer";
  Push("ann", 0, 0.01);
  Next();
  EXPECT_TRUE(queue_.WouldBeNext("ben")) << "ann had a turn";
  Push("ben", 0, 0.01, "ben");
  EXPECT_EQ(Next(), "ben");
  EXPECT_FALSE(queue_.WouldBeNext("ben")) << "both had one";
  EXPECT_TRUE(queue_.WouldBeNext("cas"));
}

TEST_F(FairQueueTest, WhoRunsLongIsToldWhenOthersAreFirst) {
  Push("ann", 0, 60);
  const auto long_job = queue_.Pop();
  EXPECT_FALSE(queue_.Precedes(long_job->share, long_job->since)) << "nobody waits";
  Push("ann", 0, 60);
  now_ += seconds(1);
  EXPECT_FALSE(queue_.Precedes(long_job->share, long_job->since)) << "an equal one, and younger";
  Push("ann", 0, 1);
  EXPECT_TRUE(queue_.Precedes(long_job->share, long_job->since)) << "a shorter one";
  Push("ben", 0, 60);
  EXPECT_TRUE(queue_.Precedes(long_job->share, long_job->since)) << "another owner";
}

TEST_F(FairQueueTest, AFullQueueHasRoomForThoseWithLessThanAnEqualPart) {
  for (int i = 0; i < 8; ++i) {
    EXPECT_TRUE(queue_.HasRoom("ann", 8));
    Push("ann", 0, 1);
  }
  EXPECT_FALSE(queue_.HasRoom("ann", 8));
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(queue_.HasRoom("ben", 8)) << i;
    Push("ben", 0, 1);
  }
  EXPECT_FALSE(queue_.HasRoom("ben", 8));
  EXPECT_TRUE(queue_.HasRoom("cas", 8));
  queue_.Push({{"cas", 0, 1}, now_, {}}, false);
  EXPECT_TRUE(queue_.HasRoom("cas", 8)) << "frames of streams do not count";
  EXPECT_FALSE(queue_.HasRoom("dan", 3)) << "an equal part that is less than one";
}

TEST_F(FairQueueTest, TheUsersOfAGatewayHaveOnePartOfAFullQueue) {
  for (int i = 0; i < 8; ++i) Push("hub/" + std::to_string(i), 0, 1);
  EXPECT_FALSE(queue_.HasRoom("hub/9", 8));
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(queue_.HasRoom("ann", 8)) << i;
    Push("ann", 0, 1);
  }
  EXPECT_FALSE(queue_.HasRoom("ann", 8));
}

TEST_F(FairQueueTest, SaysWhatANewcomerWouldFind) {
  EXPECT_EQ(queue_.OutlookOf("ann").place, 0u);
  for (int i = 0; i < 3; ++i) Push("ann", 0, 2);
  Push("ben", 0, 1);
  EXPECT_EQ(queue_.OutlookOf("ann").place, 3u);
  EXPECT_EQ(queue_.OutlookOf("ann").seconds, 12) << "half of the lane is ben's";
  EXPECT_EQ(queue_.OutlookOf("cas").seconds, 0);
  EXPECT_EQ(queue_.size(), 4u);
  EXPECT_EQ(queue_.oldest(), now_);
}

TEST_F(FairQueueTest, ThousandsThatCameOnceAreForgottenAndEveryEntryComesOnce) {
  testing::Random random(1);
  std::size_t pushed = 0;
  std::size_t popped = 0;
  for (int i = 0; i < 20'000; ++i) {
    Push("owner" + std::to_string(random.Below(5'000)), random.Below(3), 0.001);
    ++pushed;
    if (i % 3 != 0) {
      Work(0.001);
      ++popped;
    }
  }
  while (!queue_.empty()) {
    Work(0.001);
    ++popped;
  }
  EXPECT_EQ(popped, pushed);
}

TEST_F(FairQueueTest, TheNextOfAKindIsTakenOutOfTurn) {
  Push("ann", 1, 0.01, "a1");
  Push("ann", 2, 0.01, "b2");
  Push("ben", 0, 0.01, "b3");
  const auto is_b = [](const Queue::Entry& entry) { return entry.item[0] == 'b'; };
  EXPECT_EQ(queue_.PopWhere(is_b)->item, "b2") << "ann has come first";
  EXPECT_EQ(queue_.PopWhere(is_b)->item, "b3");
  EXPECT_FALSE(queue_.PopWhere(is_b).has_value());
  EXPECT_EQ(queue_.size(), 1u);
  Push("ann", 2, 0.01, "b4");
  EXPECT_EQ(Next(), "a1") << "the other stream was served more";
}

}  // namespace
}  // namespace arap::runtime
