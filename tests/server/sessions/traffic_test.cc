// Many threads on one engine: sessions, edits, evictions and sweeps at the same time. What counts
// is that nothing is lost and, under ThreadSanitizer, that nothing races.
#include <atomic>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "arap/core/deformer.h"
#include "server/engine.h"
#include "server/sessions/handle_sets.h"
#include "server/sessions/meshes.h"
#include "tests/support/bounded.h"
#include "tests/support/fake_clock.h"
#include "tests/support/meshes.h"
#include "tests/support/poses.h"

namespace arap::app {
namespace {

constexpr int kRounds = 30;

class TrafficTest : public ::testing::Test {
 protected:
  void Deform(const Caller& caller, const std::string& id) {
    auto session = engine_.sessions.Use(caller.owner, id);
    ASSERT_TRUE(session) << session.error().message;
    auto entry = WarmHandleSet(engine_, caller, **session, "h", {});
    ASSERT_TRUE(entry) << entry.error().message;
    Deformer deformer(entry->handles);
    EXPECT_TRUE(deformer.Update(entry->handles->RestTargets(), {}));
  }

  void Open(const Caller& caller) {
    ASSERT_TRUE(engine_.sessions.Create(caller, {"s", std::chrono::minutes(1), {}}));
    ASSERT_TRUE(RegisterMesh(engine_, caller, "s", "m", testing::JitteredGrid(6, 6, 3), {}, {}));
    ASSERT_TRUE(CompileHandles(engine_, caller, "s", "m", "h", {testing::AtVertex(0)}, {}));
  }

  // One owner's life on one session that its other threads use too.
  void Live(const Caller& caller, int seed) {
    const std::string id = "s";
    for (int round = 0; round < kRounds; ++round) {
      const auto vertex = static_cast<std::uint32_t>(1 + (seed * kRounds + round) % 40);
      const std::string name = "v" + std::to_string(vertex);
      // Its own names never collide: whatever it adds is there until it takes it away.
      auto handle = testing::AtVertex(vertex);
      handle.id = name + "_" + std::to_string(seed);
      EXPECT_TRUE(EditHandles(engine_, caller, id, "h", {}, {handle}, {}));
      Deform(caller, id);
      EXPECT_TRUE(EditHandles(engine_, caller, id, "h", {handle.id}, {}, {}));
      EXPECT_TRUE(engine_.sessions.List(caller.owner, 0, ""));
    }
  }

  runtime::FakeClock clock_;
  Engine engine_{Limits{}, Lanes{1, 1}, clock_, *store::OpenStores({})};
};

TEST_F(TrafficTest, NothingIsLost) {
  const Caller ann{"ann", Role::kUser, {}}, ben{"ben", Role::kUser, {}};
  std::atomic<bool> done = false;
  testing::BoundedThread sweeper("the sweeper", [&] {
    while (!done) {
      EXPECT_TRUE(engine_.Sweep());
      engine_.derived.EvictIdle(std::chrono::seconds(0));
      EXPECT_TRUE(engine_.keeper.Collect({std::chrono::hours(1), std::chrono::seconds(0)}));
      static_cast<void>(engine_.metrics.Text());
    }
  });
  for (const Caller& caller : {ann, ben}) Open(caller);
  std::vector<testing::BoundedThread> lives;
  for (int i = 0; i < 4; ++i) {
    lives.emplace_back("the calls of an owner",
                       [this, &caller = i % 2 == 0 ? ann : ben, i] { Live(caller, i); });
  }
  lives.clear();
  done = true;
  sweeper.Join();
  for (const Caller& caller : {ann, ben}) {
    const auto session = engine_.sessions.Use(caller.owner, "s");
    ASSERT_TRUE(session);
    const auto set = FindHandleSet(*(*session)->record(), "h");
    ASSERT_TRUE(set);
    EXPECT_EQ(set->definitions->size(), 1u);
    EXPECT_EQ(set->revision, 1u + 2 * 2 * kRounds) << "every edit has counted";
    EXPECT_TRUE(engine_.sessions.Delete(caller.owner, "s"));
  }
  engine_.derived.EvictIdle(std::chrono::seconds(0));
  EXPECT_EQ(engine_.derived.bytes() - engine_.sessions.bytes(), 0u);
}

}  // namespace
}  // namespace arap::app
