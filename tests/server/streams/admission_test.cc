// Admission: by load, by rate, by number.
#include "server/streams/admission.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/budget/gate.h"
#include "server/runtime/token_bucket.h"

namespace arap::app {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
const Admission::Time kStart{seconds(1'000)};

// Streams by the address of a number.
struct Streams {
  const int ids[2'000] = {};
  Admission::Stream operator[](std::size_t i) const { return &ids[i]; }
} const stream;

TEST(AdmissionTest, RefusesOnlyWhatIsNotThereAndSaysWhatWouldFit) {
  Admission admission(0.5, 2);
  EXPECT_TRUE(admission.WakeUp(stream[0], "ann", 0.4, kStart));
  EXPECT_TRUE(admission.WakeUp(stream[1], "ann", 0.4, kStart));
  const auto refused = admission.WakeUp(stream[2], "ann", 0.4, kStart);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(DetailOf(refused.error(), "quota"), "max_stream_load");
  EXPECT_EQ(DetailOf(refused.error(), "floor_fps"), "30");
  EXPECT_EQ(DetailOf(refused.error(), "load"), "0.800");
  EXPECT_EQ(DetailOf(refused.error(), "fits_frame_ms"), "6.667");
  EXPECT_NEAR(admission.Entitled(kStart), 0.8, 1e-9) << "who is refused does not count";
  EXPECT_TRUE(admission.WakeUp(stream[2], "ann", 0.0066 * kFloorFps, kStart));
}

TEST(AdmissionTest, OpeningCountsNothing) {
  Admission admission(0.5, 2);
  for (std::size_t i = 0; i < 100; ++i) EXPECT_TRUE(admission.MayOpen("ann", 0.9, kStart));
  EXPECT_TRUE(admission.MayOpen("ben", 0.9, kStart));
  EXPECT_EQ(admission.Entitled(kStart), 0);
}

TEST(AdmissionTest, SleepersAndThoseThatLeaveCountNothing) {
  Admission admission(0.5, 2);
  ASSERT_TRUE(admission.WakeUp(stream[0], "ann", 0.9, kStart));
  EXPECT_FALSE(admission.MayOpen("ann", 0.9, kStart + milliseconds(1'499)));
  EXPECT_TRUE(admission.MayOpen("ann", 0.9, kStart + kAwake));
  ASSERT_TRUE(admission.WakeUp(stream[0], "ann", 0.9, kStart + kAwake));
  admission.StaysAwake(stream[0], 0.8, kStart + 2 * kAwake - milliseconds(1));
  EXPECT_NEAR(admission.Entitled(kStart + 2 * kAwake), 0.8, 1e-9);
  admission.Leave(stream[0]);
  EXPECT_TRUE(admission.MayOpen("ann", 0.9, kStart + 2 * kAwake));
}

TEST(AdmissionTest, NoOwnerKeepsAnotherOut) {
  Admission admission(0.5, 2);
  std::size_t next = 0;
  while (admission.WakeUp(stream[next], "ann", 0.25, kStart)) ++next;
  EXPECT_EQ(next, 4u);
  ++next;
  EXPECT_TRUE(admission.WakeUp(stream[next++], "ben", 1, kStart)) << "the only one of its owner";
  EXPECT_FALSE(admission.MayOpen("ben", 0.01, kStart)) << "more than an equal part";
  for (int i = 0; i < 16; ++i) {
    EXPECT_TRUE(admission.WakeUp(stream[next++], "cas", 0.02, kStart)) << i;
  }
  EXPECT_FALSE(admission.MayOpen("ann", 0.01, kStart));
}

TEST(AdmissionTest, TheUsersOfAGatewayCountAsOneOwner) {
  Admission admission(0.5, 2);
  std::size_t next = 0;
  while (admission.WakeUp(stream[next], "hub/" + std::to_string(next), 0.25, kStart)) ++next;
  EXPECT_EQ(next, 4u) << "each is the only stream of its user, but not of the gateway";
  ++next;
  EXPECT_TRUE(admission.WakeUp(stream[next++], "ann", 0.25, kStart));
  EXPECT_TRUE(admission.WakeUp(stream[next++], "ann", 0.25, kStart)) << "half is hers";
  EXPECT_FALSE(admission.MayOpen("ann", 0.01, kStart));
}

TEST(AdmissionTest, AnIdleServerTakesTheLargestStream) {
  Admission admission(0.5, 1);
  EXPECT_TRUE(admission.WakeUp(stream[0], "ann", 1, kStart));
  EXPECT_FALSE(admission.WakeUp(stream[1], "ann", 0.01, kStart));
}

TEST(AdmissionTest, NoLimitRefusesNobody) {
  Admission admission(0, 1);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_TRUE(admission.WakeUp(stream[i], "ann", 1, kStart));
}

TEST(StreamPaceTest, GreedIsNoLoad) {
  StreamPace modest(1e-3);
  StreamPace greedy(1e-3);
  EXPECT_NEAR(modest.Share(), 0.03, 1e-9) << "nothing is known of it yet";
  for (int i = 0; i <= 4'000; ++i) {
    greedy.Update(kStart + i * milliseconds(1));
    if (i % 100 == 0) modest.Update(kStart + i * milliseconds(1));
  }
  EXPECT_NEAR(greedy.Share(), 0.03, 1e-9);
  EXPECT_NEAR(modest.Share(), 0.01, 1e-3) << "it asks for ten a second";
}

TEST(StreamPaceTest, SleepsUntilItsNextUpdate) {
  StreamPace pace(1e-3);
  EXPECT_TRUE(pace.Asleep(kStart)) << "it has only been opened";
  pace.Update(kStart);
  EXPECT_FALSE(pace.Asleep(kStart + milliseconds(1'499)));
  EXPECT_TRUE(pace.Asleep(kStart + milliseconds(1'500)));
}

TEST(StreamPaceTest, LearnsWhatItsFramesTake) {
  StreamPace pace(1e-3);
  for (int i = 0; i < 50; ++i) pace.Took(4e-3);
  EXPECT_NEAR(pace.frame_seconds(), 4e-3, 1e-5);
  EXPECT_NEAR(pace.Share(), 0.12, 1e-3);
  EXPECT_FALSE(pace.LongFrames());
  for (int i = 0; i < 50; ++i) pace.Took(1);
  EXPECT_TRUE(pace.LongFrames());
  EXPECT_EQ(pace.Share(), 0) << "they are jobs";
}

TEST(TokenBucketTest, GrantsABurstOfAnotherSize) {
  auto now = Admission::Time();
  runtime::TokenBucket bucket(2, 3, now);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(bucket.Take(now));
  EXPECT_FALSE(bucket.Take(now));
  now += std::chrono::milliseconds(500);
  EXPECT_TRUE(bucket.Take(now));
  EXPECT_FALSE(bucket.Take(now));
  bucket.Fill();
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(bucket.Take(now));
  EXPECT_FALSE(bucket.Take(now));
}

TEST(TokenBucketTest, GrantsABurstThenTheRate) {
  runtime::Clock::Steady now{seconds(5)};
  runtime::TokenBucket bucket(10, now);
  int granted = 0;
  for (int i = 0; i < 100; ++i) granted += bucket.Take(now) ? 1 : 0;
  EXPECT_EQ(granted, 10);
  now += milliseconds(300);
  granted = 0;
  for (int i = 0; i < 100; ++i) granted += bucket.Take(now) ? 1 : 0;
  EXPECT_EQ(granted, 3);
  now += std::chrono::hours(1);
  granted = 0;
  for (int i = 0; i < 100; ++i) granted += bucket.Take(now) ? 1 : 0;
  EXPECT_EQ(granted, 10) << "no more than a burst is saved";
}

TEST(GateTest, AdmitsSoManyAtOnce) {
  Gate gate("max_flattenings", 2);
  auto first = gate.Enter("ann");
  auto second = gate.Enter("ann");
  ASSERT_TRUE(first && second);
  const auto third = gate.Enter("ann");
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().details.front().second, "max_flattenings");
  EXPECT_EQ(gate.inside(), 2u);
  first->reset();
  EXPECT_TRUE(gate.Enter("ann"));
  EXPECT_EQ(gate.inside(), 1u) << "a pass that goes at once leaves at once";
}

TEST(GateTest, TheUsersOfAGatewayHaveOnePart) {
  Gate gate("max_registrations", 4);
  std::vector<Gate::Pass> passes;
  for (int i = 0; i < 4; ++i) passes.push_back(gate.Enter("hub/" + std::to_string(i)).value());
  EXPECT_FALSE(gate.Enter("hub/5"));
  auto first = gate.Enter("ann");
  auto second = gate.Enter("ann");
  EXPECT_TRUE(first && second);
  EXPECT_FALSE(gate.Enter("ann"));
  passes.clear();
  EXPECT_TRUE(gate.Enter("hub/5"));
}

}  // namespace
}  // namespace arap::app
