// Work that is given up halfway, wherever that is: its memory comes back, and the store never
// hears of it.
#include <utility>

#include <gtest/gtest.h>

#include "arap/core/cost.h"
#include "server/engine.h"
#include "server/sessions/handle_sets.h"
#include "server/sessions/meshes.h"
#include "tests/support/fake_clock.h"
#include "tests/support/meshes.h"

namespace arap::app {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

class CancelledWorkTest : public ::testing::Test {
 protected:
  CancelledWorkTest() { EXPECT_TRUE(engine_.sessions.Create(ann_, {"s", minutes(60), {}})); }

  static PlanarMesh Mesh() { return testing::JitteredGrid(40, 30, 7); }
  static std::vector<Handle> Handles() {
    std::vector<Handle> handles;
    for (const std::uint32_t vertex : {0u, 40u, 635u, 1230u, 1270u}) {
      handles.emplace_back().id = "v" + std::to_string(vertex);
      handles.back().anchor = VertexAnchor{vertex};
    }
    return handles;
  }
  Result<Registration> Register(const Caller& caller, const CancelToken& cancel) {
    return RegisterMesh(engine_, caller, "s", "m", Mesh(), {}, cancel);
  }

  // Runs `job` with a token that fires at the first time it is asked, then at the second, and so
  // on, until it fires no more; says how often it did. `check` looks at what every end has left.
  template <class Job, class Check>
  std::size_t CancelEverywhere(Job job, Check check) {
    for (std::size_t fires_at = 0;; ++fires_at) {
      SCOPED_TRACE("cancelled at question " + std::to_string(fires_at));
      std::size_t asked = 0;
      const CancelToken token([&]() -> Status {
        if (asked++ < fires_at) return {};
        return Fail(FaultKind::kCancelled, "The caller has cancelled.");
      });
      const auto done = job(token);
      if (done) return fires_at;
      EXPECT_EQ(done.error().kind, FaultKind::kCancelled) << done.error().message;
      EXPECT_EQ(asked, fires_at + 1) << "nobody asks twice";
      check();
      if (HasFailure()) return fires_at;
    }
  }

  runtime::FakeClock clock_;
  const Caller ann_{"ann", Role::kUser, {}};
  Engine engine_{Limits{}, Lanes{1, 1}, clock_, *store::OpenStores({})};
};

TEST_F(CancelledWorkTest, ARegistrationLeavesNothing) {
  // What is not given back is missed by the next attempt: there is room for one.
  Caller small = ann_;
  // Of the mesh, beside the session's record before and after.
  small.limits.max_bytes = EstimateRegistration(Mesh().vertices.size(), Basis::kEdge).bytes + 1'024;
  const std::size_t places =
      CancelEverywhere([&](const CancelToken& token) { return Register(small, token); },
                       [&] {
                         EXPECT_EQ(engine_.derived.bytes() - engine_.sessions.bytes(), 0u);
                         EXPECT_EQ(engine_.derived.bytes_of("ann") - engine_.sessions.bytes(), 0u);
                         EXPECT_TRUE(engine_.sessions.View("ann", "s")->mesh_ids.empty());
                         EXPECT_TRUE(engine_.stores.specs->ReferencedBlobs()->empty());
                         EXPECT_EQ(engine_.keeper.Collect({seconds(0), seconds(0)})->removed, 0u)
                             << "a blob without a record";
                       });
  EXPECT_GE(places, 3u) << "before, between and after the factorisations";
  EXPECT_EQ(engine_.derived.entries(DerivedKind::kMesh), 1u);
  EXPECT_EQ(engine_.sessions.View("ann", "s")->mesh_ids.size(), 1u);
}

TEST_F(CancelledWorkTest, ARebuildLeavesTheMeshAtMost) {
  ASSERT_TRUE(Register(ann_, {}));
  const std::size_t mesh = engine_.derived.bytes() - engine_.sessions.bytes();
  ASSERT_TRUE(CompileHandles(engine_, ann_, "s", "m", "h", Handles(), {}));
  const auto session = *engine_.sessions.Use("ann", "s");
  const std::size_t places = CancelEverywhere(
      [&](const CancelToken& token) {
        engine_.derived.EvictIdle(seconds(0));
        EXPECT_EQ(engine_.derived.bytes() - engine_.sessions.bytes(), 0u);
        return WarmHandleSet(engine_, ann_, *session, "h", token);
      },
      [&] {
        EXPECT_EQ(engine_.derived.entries(DerivedKind::kHandleSet), 0u);
        // It was whole already, and the next attempt begins with it.
        const std::size_t kept = engine_.derived.entries(DerivedKind::kMesh);
        EXPECT_EQ(engine_.derived.bytes() - engine_.sessions.bytes(), kept * mesh);
      });
  EXPECT_GE(places, 5u) << "in the registration and in the compilation";
}

// A session that ends meanwhile is found missing only when the mesh is to be stored.
TEST_F(CancelledWorkTest, ARegistrationWhoseSessionEndsLeavesABlobAtMost) {
  bool ended = false;
  const CancelToken ends([&] {
    if (!std::exchange(ended, true)) {
      EXPECT_TRUE(engine_.sessions.Delete("ann", "s"));
    }
    return Status{};
  });
  const auto registration = Register(ann_, ends);
  ASSERT_FALSE(registration);
  EXPECT_EQ(registration.error().kind, FaultKind::kNotFound);
  EXPECT_EQ(engine_.derived.bytes() - engine_.sessions.bytes(), 0u);
  EXPECT_TRUE(engine_.stores.specs->ReferencedBlobs()->empty());
  EXPECT_EQ(engine_.keeper.Collect({seconds(0), seconds(0)})->kept, 0u);
}

}  // namespace
}  // namespace arap::app
