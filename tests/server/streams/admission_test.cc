// Admission: by load, by rate, by number.
#include "server/streams/admission.h"

#include <gtest/gtest.h>

#include "server/budget/gate.h"

namespace arap::app {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Busy = LoadGuard::Seconds;

const LoadGuard::Time kStart{seconds(1'000)};

TEST(LoadGuardTest, NewcomersCountUntilTheyAreMeasured) {
  LoadGuard guard(0.5, 2);
  EXPECT_TRUE(guard.Admit(0.4, Busy(0), kStart));
  EXPECT_TRUE(guard.Admit(0.4, Busy(0), kStart));
  const auto refused = guard.Admit(0.4, Busy(0), kStart);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(refused.error().details.front().second, "max_stream_load");
  // They turn out to do nothing.
  EXPECT_TRUE(guard.Admit(0.4, Busy(0), kStart + LoadGuard::kWindow));
}

TEST(LoadGuardTest, MeasuredLoadRefusesAndItsEndAdmits) {
  LoadGuard guard(0.5, 2);
  ASSERT_TRUE(guard.Admit(0.1, Busy(0), kStart));
  // 1.2 of 2 workers for four seconds.
  Busy busy(0);
  LoadGuard::Time now = kStart;
  for (int i = 0; i < 40; ++i) {
    now += milliseconds(100);
    busy += Busy(0.12);
    const bool admitted = guard.Admit(0.01, busy, now).has_value();
    if (i > 20) {
      EXPECT_FALSE(admitted) << i;
    }
  }
  EXPECT_NEAR(guard.Measured(), 0.6, 0.01);
  for (int i = 0; i < 20; ++i) {
    now += milliseconds(100);
    static_cast<void>(guard.Admit(10, busy, now));
  }
  EXPECT_LT(guard.Measured(), 0.01);
}

TEST(LoadGuardTest, WhatWasLongAgoDoesNotCount) {
  LoadGuard guard(0.5, 1);
  LoadGuard::Time now = kStart;
  ASSERT_TRUE(guard.Admit(0.4, Busy(0), now));
  // Busy for a minute in which nobody asks.
  Busy busy(0);
  for (int second = 0; second < 60; ++second) guard.Look(busy += seconds(1), now += seconds(1));
  EXPECT_FALSE(guard.Admit(0.4, busy, now));
  for (int second = 0; second < 3; ++second) guard.Look(busy, now += seconds(1));
  EXPECT_TRUE(guard.Admit(0.4, busy, now));
}

TEST(LoadGuardTest, AnIdleServerTakesTheLargestStream) {
  LoadGuard guard(0.5, 2);
  EXPECT_TRUE(guard.Admit(100, Busy(0), kStart));
  EXPECT_FALSE(guard.Admit(0.01, Busy(0), kStart));
}

TEST(LoadGuardTest, NoLimitRefusesNobody) {
  LoadGuard guard(0, 1);
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(guard.Admit(1, Busy(0), kStart));
}

TEST(StreamPaceTest, LargerMeshesAreExpectedToCostMore) {
  EXPECT_LT(FrameSeconds(1'000, 0), FrameSeconds(10'000, 0));
  EXPECT_LT(FrameSeconds(10'000, 0), FrameSeconds(10'000, 3));
  EXPECT_LT(StreamPace(FrameSeconds(10'000, 0), kStart).Share(), 1);
  EXPECT_EQ(StreamPace(FrameSeconds(1'000'000, 100), kStart).Share(), 1)
      << "one frame at a time is all that a stream can have";
}

TEST(StreamPaceTest, CountsAsWhenItWasLastAwake) {
  StreamPace pace(1e-3, kStart);
  EXPECT_NEAR(pace.Share(), 0.06, 1e-9) << "nothing is known of it yet";
  EXPECT_FALSE(pace.Asleep(kStart + milliseconds(1'499)));
  EXPECT_TRUE(pace.Asleep(kStart + milliseconds(1'500)));
  // 3 s at 20 updates a second.
  LoadGuard::Time now = kStart + seconds(10);
  for (int i = 0; i <= 60; ++i) pace.Update(now + i * milliseconds(50));
  now += seconds(3);
  EXPECT_NEAR(pace.Share(), 0.02, 1e-3);
  EXPECT_FALSE(pace.Asleep(now + milliseconds(100)));
  // One update now and then is next to nothing.
  for (int i = 0; i < 5; ++i) pace.Update(now += seconds(2));
  EXPECT_NEAR(pace.Share(), 1e-3 / 1.5, 1e-9);
}

TEST(TokenBucketTest, GrantsABurstThenTheRate) {
  runtime::Clock::Steady now{seconds(5)};
  TokenBucket bucket(10, now);
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
  auto first = gate.Enter();
  auto second = gate.Enter();
  ASSERT_TRUE(first && second);
  const auto third = gate.Enter();
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().details.front().second, "max_flattenings");
  EXPECT_EQ(gate.inside(), 2u);
  first->reset();
  EXPECT_TRUE(gate.Enter());
  EXPECT_EQ(gate.inside(), 1u) << "a pass that goes at once leaves at once";
}

}  // namespace
}  // namespace arap::app
