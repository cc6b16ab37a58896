// Whose memory it is, and whose goes first.
#include "server/budget/derived_cache.h"

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/fake_clock.h"

namespace arap::app {
namespace {

class DerivedCacheTest : public ::testing::Test {
 protected:
  static Caller Owner(const std::string& name, std::size_t max_bytes = 1'000) {
    Caller caller;
    caller.owner = name;
    caller.limits.max_bytes = max_bytes;
    return caller;
  }
  void Keep(const std::string& owner, DerivedKind kind, const std::string& name,
            std::size_t bytes) {
    cache_.Keep<int>({owner, kind, name}, std::make_shared<const int>(0), bytes);
    clock_.Advance(std::chrono::seconds(1));
  }
  bool Has(const std::string& owner, DerivedKind kind, const std::string& name) const {
    return cache_.Has({owner, kind, name});
  }

  runtime::FakeClock clock_;
  DerivedCache cache_{1'000, {4, 500}, clock_};
};

TEST_F(DerivedCacheTest, ManySmallSurfacesEvictTheirOwnersOnly) {
  Keep("ann", DerivedKind::kSurface, "bust", 100);
  for (int i = 0; i < 64; ++i) Keep("ben", DerivedKind::kSurface, std::to_string(i), 1);
  EXPECT_TRUE(Has("ann", DerivedKind::kSurface, "bust"));
  EXPECT_TRUE(Has("ben", DerivedKind::kSurface, "63"));
  EXPECT_EQ(cache_.entries(DerivedKind::kSurface), 4u);
}

TEST_F(DerivedCacheTest, OneLargeSurfaceEvictsItsOwnersOnly) {
  Keep("ann", DerivedKind::kSurface, "bust", 100);
  Keep("ben", DerivedKind::kSurface, "old", 250);
  Keep("ben", DerivedKind::kSurface, "new", 250);
  EXPECT_TRUE(Has("ann", DerivedKind::kSurface, "bust"));
  EXPECT_FALSE(Has("ben", DerivedKind::kSurface, "old"));
}

TEST_F(DerivedCacheTest, UsersOfAGatewayShareItsBytes) {
  Keep("hub2/mia", DerivedKind::kMesh, "other", 100);
  Keep("hub/mia", DerivedKind::kMesh, "old", 200);
  Keep("hub/ben", DerivedKind::kMesh, "new", 200);
  Caller caller = Owner("hub/cas");
  caller.gateway = Gateway{"hub", {}};
  caller.gateway->limits.max_bytes = 500;
  auto room = cache_.Reserve(caller, 300);
  ASSERT_TRUE(room);
  EXPECT_FALSE(Has("hub/mia", DerivedKind::kMesh, "old"));
  EXPECT_TRUE(Has("hub/ben", DerivedKind::kMesh, "new"));
  EXPECT_TRUE(Has("hub2/mia", DerivedKind::kMesh, "other")) << "the name only begins alike";
  const auto refused = cache_.Reserve(caller, 300);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().details.front().second, "max_bytes_per_gateway");
}

TEST_F(DerivedCacheTest, AmongTheUsersOfAGatewayWhoHasMoreThanAPartGivesRoomFirst) {
  Keep("hub/mia", DerivedKind::kMesh, "small", 50);
  Keep("hub/ben", DerivedKind::kMesh, "large", 400);
  Caller caller = Owner("hub/cas");
  caller.gateway = Gateway{"hub", {}};
  caller.gateway->limits.max_bytes = 500;
  EXPECT_TRUE(cache_.Reserve(caller, 100));
  EXPECT_TRUE(Has("hub/mia", DerivedKind::kMesh, "small")) << "the oldest, and yet not it";
  EXPECT_FALSE(Has("hub/ben", DerivedKind::kMesh, "large"));
}

TEST_F(DerivedCacheTest, AGatewayIsOneOwnerAmongOthers) {
  Keep("ann", DerivedKind::kMesh, "hers", 300);
  for (int i = 0; i < 60; ++i) {
    Keep("hub/" + std::to_string(i), DerivedKind::kMesh, "m", 10);
  }
  EXPECT_TRUE(cache_.Reserve(Owner("cas"), 200));
  EXPECT_TRUE(Has("ann", DerivedKind::kMesh, "hers")) << "the oldest, but less than a third";
}

TEST_F(DerivedCacheTest, WhatNeverFitsTheGatewayPushesNobodyOut) {
  Keep("hub/mia", DerivedKind::kMesh, "m", 100);
  Caller caller = Owner("hub/mia");
  caller.gateway = Gateway{"hub", {}};
  caller.gateway->limits.max_bytes = 500;
  EXPECT_FALSE(cache_.Reserve(caller, 600));
  EXPECT_TRUE(Has("hub/mia", DerivedKind::kMesh, "m"));
}

TEST_F(DerivedCacheTest, WhoHasMoreThanAPartGivesRoomFirst) {
  Keep("ann", DerivedKind::kMesh, "a", 100);
  Keep("ben", DerivedKind::kMesh, "b", 400);
  Keep("ben", DerivedKind::kMesh, "c", 400);
  auto room = cache_.Reserve(Owner("cas"), 300);
  ASSERT_TRUE(room);
  EXPECT_TRUE(Has("ann", DerivedKind::kMesh, "a")) << "the oldest, and yet not the one to go";
  EXPECT_FALSE(Has("ben", DerivedKind::kMesh, "b"));
}

TEST_F(DerivedCacheTest, SaysWhetherItCouldEverFit) {
  auto room = cache_.Reserve(Owner("ann"), 900);
  ASSERT_TRUE(room);
  const auto now_full = cache_.Reserve(Owner("ben"), 200);
  ASSERT_FALSE(now_full);
  EXPECT_EQ(DetailOf(now_full.error(), kRetryDelayDetail), "");
  const auto never = cache_.Reserve(Owner("ben", 100), 101);
  ASSERT_FALSE(never);
  EXPECT_EQ(DetailOf(never.error(), "quota"), "max_bytes_per_owner");
  EXPECT_EQ(DetailOf(never.error(), kRetryDelayDetail), "0");
}

TEST_F(DerivedCacheTest, RoomShrinksToWhatIsNeeded) {
  auto room = cache_.Reserve(Owner("ann"), 900);
  ASSERT_TRUE(room);
  room->Shrink(100);
  EXPECT_EQ(cache_.bytes_of("ann"), 100u);
  room->Shrink(200);
  EXPECT_EQ(cache_.bytes_of("ann"), 100u) << "and never grows";
  room->Release();
  EXPECT_EQ(cache_.bytes(), 0u);
}

TEST_F(DerivedCacheTest, WhatIsThereAlreadyCountsThoughThereIsNoRoom) {
  {
    const auto held = cache_.Hold("ann", 2'000);
    EXPECT_EQ(cache_.bytes_of("ann"), 2'000u);
    EXPECT_FALSE(cache_.Reserve(Owner("ben"), 1));
  }
  EXPECT_TRUE(cache_.Reserve(Owner("ben"), 1));
}

}  // namespace
}  // namespace arap::app
