// The server's rooms below the wire: sessions, the mesh cache, cancellation, targets, poses.
#include <complex>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "server/app/engine.h"
#include "server/app/handle_sets.h"
#include "server/app/live_set.h"
#include "server/app/names.h"
#include "server/app/pose.h"
#include "server/app/registration.h"
#include "server/app/targets.h"
#include "server/runtime/fake_clock.h"

namespace arap::app {
namespace {

using std::chrono::seconds;

// Two triangles: the unit square.
PlanarMesh Square() { return {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}}; }

Handle AtVertex(const std::string& id, std::uint32_t vertex) {
  Handle handle;
  handle.id = id;
  handle.anchor = VertexAnchor{vertex};
  return handle;
}

class AppTest : public ::testing::Test {
 protected:
  std::shared_ptr<Session> Open(const std::string& id, seconds ttl = seconds(60)) {
    EXPECT_TRUE(engine_.sessions.Create({id, ttl, {}}));
    return *engine_.sessions.Use(id);
  }

  runtime::FakeClock clock_;
  Engine engine_{Limits{}, Lanes{1, 1, 8}, clock_};
};

TEST_F(AppTest, EndOfASessionIsToldOnce) {
  auto session = Open("s");
  int told = 0;
  int removed = 0;
  session->AddEndListener([&] { ++told; });
  session->RemoveEndListener(session->AddEndListener([&] { ++removed; }));
  ASSERT_TRUE(engine_.sessions.Delete("s"));
  EXPECT_EQ(told, 1);
  EXPECT_EQ(removed, 0);
  session->End();
  EXPECT_EQ(told, 1);
  session->AddEndListener([&] { ++told; });
  EXPECT_EQ(told, 2) << "at once when it has ended";
}

TEST_F(AppTest, ExpiryIsToldWhenSomebodyLooks) {
  auto session = Open("s", seconds(5));
  int told = 0;
  session->AddEndListener([&] { ++told; });
  clock_.Advance(seconds(5));
  EXPECT_EQ(told, 0);
  EXPECT_TRUE(engine_.sessions.List(0, "")->sessions.empty());
  EXPECT_EQ(told, 1);
  EXPECT_FALSE(session->Touch()) << "an expired session does not come back";
}

TEST_F(AppTest, EndedSessionTakesNothing) {
  auto session = Open("s");
  ASSERT_TRUE(RegisterMesh(engine_, "s", "m", Square(), {}, {}));
  const auto entry = *session->FindMesh("m");
  ASSERT_TRUE(engine_.sessions.Delete("s"));
  const auto added = session->AddMesh(entry, engine_.limits);
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().kind, FaultKind::kNotFound);
}

TEST_F(AppTest, CacheHoldsNothingAlive) {
  Open("s");
  Open("t");
  const auto first = RegisterMesh(engine_, "s", "m", Square(), {}, {});
  ASSERT_TRUE(first);
  const auto second = RegisterMesh(engine_, "t", "m", Square(), {}, {});
  ASSERT_TRUE(second);
  EXPECT_EQ(first->entry.mesh, second->entry.mesh);
  const std::weak_ptr<const RegisteredMesh> mesh = first->entry.mesh;
  const std::string hash = first->entry.content_hash;
  EXPECT_NE(engine_.meshes.Find(hash), nullptr);
  ASSERT_TRUE(engine_.sessions.Delete("s"));
  ASSERT_TRUE(engine_.sessions.Delete("t"));
  EXPECT_NE(engine_.meshes.Find(hash), nullptr) << "running work still holds it";
}

TEST_F(AppTest, DeletedMeshIsFreed) {
  auto session = Open("s");
  std::weak_ptr<const RegisteredMesh> mesh;
  std::string hash;
  {
    const auto registration = RegisterMesh(engine_, "s", "m", Square(), {}, {});
    ASSERT_TRUE(registration);
    mesh = registration->entry.mesh;
    hash = registration->entry.content_hash;
  }
  ASSERT_TRUE(CompileHandles(engine_, "s", "m", "h", {AtVertex("a", 0)}, {}));
  EXPECT_FALSE(mesh.expired());
  ASSERT_TRUE(session->DeleteMesh("m"));
  EXPECT_TRUE(mesh.expired());
  EXPECT_EQ(engine_.meshes.Find(hash), nullptr);
}

TEST_F(AppTest, OptionsAreContentToo) {
  Open("s");
  const auto edge = RegisterMesh(engine_, "s", "m", Square(), {}, {});
  const auto face = RegisterMesh(engine_, "s", "n", Square(), {Basis::kFace, {}, {}}, {});
  const auto rigid = RegisterMesh(engine_, "s", "o", Square(), {{}, {}, {1, 2}}, {});
  ASSERT_TRUE(edge && face && rigid);
  EXPECT_NE(edge->entry.content_hash, face->entry.content_hash);
  EXPECT_NE(edge->entry.content_hash, rigid->entry.content_hash);
}

TEST_F(AppTest, CancelledWorkKeepsNothing) {
  auto session = Open("s");
  const CancelToken cancelled(
      [] { return Status(Fail(FaultKind::kCancelled, "The caller has cancelled.")); });
  const auto mesh = RegisterMesh(engine_, "s", "m", Square(), {}, cancelled);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().kind, FaultKind::kCancelled);
  EXPECT_FALSE(session->FindMesh("m"));
  ASSERT_TRUE(RegisterMesh(engine_, "s", "m", Square(), {}, {}));
  const auto set = CompileHandles(engine_, "s", "m", "h", {AtVertex("a", 0)}, cancelled);
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().kind, FaultKind::kCancelled);
  EXPECT_FALSE(session->FindHandleSet("h"));
}

TEST_F(AppTest, LateEditIsNotStored) {
  auto session = Open("s");
  ASSERT_TRUE(RegisterMesh(engine_, "s", "m", Square(), {}, {}));
  ASSERT_TRUE(CompileHandles(engine_, "s", "m", "h", {AtVertex("a", 0)}, {}));
  const auto entry = *session->FindHandleSet("h");
  const auto one = EditEntry(entry, {}, {AtVertex("b", 1)}, engine_.limits, {});
  const auto other = EditEntry(entry, {}, {AtVertex("c", 2)}, engine_.limits, {});
  ASSERT_TRUE(one && other);
  EXPECT_TRUE(*session->ReplaceHandleSet(*one));
  EXPECT_FALSE(*session->ReplaceHandleSet(*other));
  // Editing through the front door does the second edit on the result of the first.
  const auto both = EditHandles(engine_, "s", "h", {}, {AtVertex("c", 2)}, {});
  ASSERT_TRUE(both);
  EXPECT_EQ(both->revision, 3u);
  EXPECT_EQ(both->handles->handles().size(), 3u);
}

class PoseTest : public AppTest {
 protected:
  void SetUp() override {
    Open("s");
    ASSERT_TRUE(RegisterMesh(engine_, "s", "m", Square(), {}, {}));
  }

  PlacedHandle Placed(const Handle& handle) {
    const std::string set = "set" + std::to_string(sets_++);
    const auto entry = CompileHandles(engine_, "s", "m", set, {handle}, {});
    EXPECT_TRUE(entry);
    return entry->handles->handles().front();
  }

  int sets_ = 0;
};

TEST_F(PoseTest, EveryKindOfAnchorFollowsTheShape) {
  // Turned by a quarter, doubled, moved.
  const Complex a(0, 2);
  const Complex b(5, -1);
  std::vector<Complex> now;
  for (const Complex& vertex : Square().vertices) now.push_back(a * vertex + b);

  Handle point = AtVertex("p", 0);
  point.anchor = PointAnchor{{0.25, 0.5}};
  Handle in_triangle = AtVertex("t", 0);
  in_triangle.anchor = TriangleAnchor{1, {0.5, 0.25, 0.25}};
  Handle snapped = AtVertex("n", 0);
  snapped.anchor = PointAnchor{{0.3, -7}};
  snapped.outside = Outside::kSnap;
  for (const Handle& handle : {AtVertex("v", 2), point, in_triangle, snapped}) {
    const PlacedHandle placed = Placed(handle);
    const Target pose = PoseOf(Square(), placed, now);
    EXPECT_LT(std::abs(pose.position - (a * placed.rest + b)), 1e-9) << handle.id;
    EXPECT_NEAR(pose.angle, std::arg(a), 1e-9) << handle.id;
    EXPECT_NEAR(pose.scale, 2, 1e-9) << handle.id;
  }
}

TEST_F(PoseTest, CollapsedTriangleGivesNoRotation) {
  const std::vector<Complex> now(4, Complex(3, 3));
  const Target pose = PoseOf(Square(), Placed(AtVertex("v", 1)), now);
  EXPECT_EQ(pose.position, Complex(3, 3));
  EXPECT_EQ(pose.angle, 0);
  EXPECT_EQ(pose.scale, 1);
}

TEST(NamesTest, QuotesAreHarmless) {
  EXPECT_EQ(Quote("plain"), "\"plain\"");
  EXPECT_EQ(Quote("line\nbreak\x01"), "\"line?break?\"");
  EXPECT_EQ(Quote(std::string(1'000, 'x')).size(), 64u + 5u);
}

}  // namespace
}  // namespace arap::app
