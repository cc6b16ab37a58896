// A session that two servers have in memory, over one Redis.
#include <chrono>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "server/sessions/session_registry.h"
#include "server/store/memory_store.h"
#include "tests/server/store/records.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/store_kind.h"
#include "tests/support/fake_clock.h"

namespace arap::app {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

// `by` is the clock of Redis, `clock` that of the server.
struct Server {
  Server(const testing::RedisServer& redis, const runtime::Clock& clock, const runtime::Clock& by)
      : specs(redis, by),
        memory(limits.max_bytes, {}, clock),
        sessions(limits, clock, specs, memory, [](const store::SessionRecord&) {}) {}

  const Limits limits{};
  testing::RedisWithFakeTime specs;
  DerivedCache memory;
  SessionRegistry sessions;
};

class SharedSessionTest : public ::testing::Test {
 protected:
  // A session of ann, in use at the second server.
  void SetUp() override {
    ASSERT_TRUE(first_.sessions.Create({"ann", Role::kUser, {}}, {"s", minutes(60), {}}));
    auto session = second_.sessions.Use("ann", "s");
    ASSERT_TRUE(session);
    session_ = *session;
    session_->AddEndListener([this] { ended_ = true; });
  }
  // As a stream does with every update.
  void GoOn(seconds time) {
    clock_.Advance(time);
    ASSERT_TRUE(session_->Touch());
    ASSERT_TRUE(second_.sessions.Sweep());
  }

  testing::RedisServer redis_;
  runtime::FakeClock clock_;
  Server first_{redis_, clock_, clock_};
  Server second_{redis_, clock_, clock_};
  std::shared_ptr<Session> session_;
  bool ended_ = false;
};

TEST_F(SharedSessionTest, DeletedByOneEndsItsStreamsAtTheOther) {
  ASSERT_TRUE(first_.sessions.Delete("ann", "s"));
  GoOn(seconds(16));
  EXPECT_TRUE(ended_) << "when its expiry is to be stored, at the latest";
  EXPECT_FALSE(session_->Touch());
  EXPECT_EQ(second_.sessions.in_memory(), 0u);
}

TEST_F(SharedSessionTest, UsedAtOneLivesOnAtTheOther) {
  for (int i = 0; i < 8; ++i) ASSERT_NO_FATAL_FAILURE(GoOn(minutes(10)));
  EXPECT_FALSE(ended_);
  EXPECT_TRUE(first_.sessions.Use("ann", "s"));
}

TEST_F(SharedSessionTest, DeletedAndMadeAgainElsewhereIsAnotherSession) {
  ASSERT_TRUE(first_.sessions.Delete("ann", "s"));
  ASSERT_TRUE(first_.sessions.Create({"ann", Role::kUser, {}}, {"s", minutes(60), {}}));
  const auto now = second_.sessions.Use("ann", "s");
  ASSERT_TRUE(now);
  EXPECT_NE(*now, session_) << "its revision is that of the old one";
  EXPECT_TRUE(ended_);
  EXPECT_FALSE(session_->Touch());
}

TEST_F(SharedSessionTest, AShortLifeInUseAtOneLivesOnAtTheOther) {
  const Caller ann{"ann", Role::kUser, {}};
  ASSERT_TRUE(first_.sessions.Create(ann, {"brief", seconds(1), {}}));
  const auto used = first_.sessions.Use("ann", "brief");
  ASSERT_TRUE(used);
  ASSERT_TRUE(second_.sessions.Use("ann", "brief"));
  // Sweeps come late, as they do when the store is slow, and the second sweeps first.
  for (int i = 0; i < 400; ++i) {
    clock_.Advance(std::chrono::milliseconds(250));
    ASSERT_TRUE((*used)->Touch()) << i;
    if (i % 28 == 27) {
      ASSERT_TRUE(second_.sessions.Sweep());
      ASSERT_TRUE(second_.sessions.View("ann", "brief")) << i;
      ASSERT_TRUE(first_.sessions.Sweep());
    }
  }
  EXPECT_TRUE(first_.sessions.View("ann", "brief"));
}

// A server whose clock is wrong ends nobody's session, and gives its own sessions their whole
// lives.
TEST(SkewedServerTest, GoesByTheClockOfTheStore) {
  for (const int hours : {2, -2}) {
    testing::RedisServer redis;
    runtime::FakeClock clock, wrong;
    wrong.SetBy(std::chrono::hours(hours));
    Server good(redis, clock, clock), skewed(redis, wrong, clock);
    const Caller ann{"ann", Role::kUser, {}};
    for (int i = 0; i < 20; ++i) {
      Server& server = i % 2 == 0 ? good : skewed;
      ASSERT_TRUE(server.sessions.Create(ann, {"s" + std::to_string(i), minutes(10), {}}));
    }
    for (int i = 0; i < 5; ++i) {
      clock.Advance(minutes(1));
      wrong.Advance(minutes(1));
      ASSERT_TRUE(skewed.sessions.Sweep());
      ASSERT_TRUE(good.sessions.Sweep());
    }
    EXPECT_EQ(good.specs.Count(), 20u);
    EXPECT_EQ(skewed.sessions.List("ann", 0, "")->sessions.size(), 20u);
    EXPECT_TRUE(good.sessions.View("ann", "s1"));
    EXPECT_TRUE(skewed.sessions.View("ann", "s0"));
    for (runtime::FakeClock* each : {&clock, &wrong}) each->Advance(minutes(6));
    ASSERT_TRUE(skewed.sessions.Sweep());
    ASSERT_TRUE(good.sessions.Sweep());
    EXPECT_EQ(good.specs.Count(), 0u);
  }
}

// With one server the clock of its machine counts, and it may be set while sessions live.
TEST(SetClockTest, SetForthOrBackEndsNobodysSession) {
  for (const int hours : {5, -5}) {
    runtime::FakeClock clock;
    store::MemorySpecStore specs;
    const Limits limits{};
    DerivedCache memory(limits.max_bytes, {}, clock);
    SessionRegistry sessions(limits, clock, specs, memory, [](const store::SessionRecord&) {});
    const Caller ann{"ann", Role::kUser, {}};
    ASSERT_TRUE(sessions.Create(ann, {"used", minutes(60), {}}));
    // One that nobody has used since the server started.
    store::SessionRecord idle = testing::PlainRecord("ann", "idle");
    idle.expires = clock.WallNow() + minutes(60);
    ASSERT_EQ(specs.Put(idle), true);
    clock.SetBy(std::chrono::hours(hours));
    for (int i = 0; i < 80; ++i) {
      clock.Advance(minutes(1));
      ASSERT_TRUE(sessions.Use("ann", "used")) << i;
      ASSERT_TRUE(sessions.Sweep());
      ASSERT_EQ(specs.Load(idle.key)->has_value(), i < 59) << i;
    }
    EXPECT_GE((*specs.Load({"ann", "used"}))->expires, clock.WallNow() + minutes(60));
  }
}

}  // namespace
}  // namespace arap::app
