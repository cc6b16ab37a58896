// The server's rooms below the wire: sessions, the mesh cache, cancellation.
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "server/engine.h"
#include "server/sessions/handle_sets.h"
#include "server/sessions/meshes.h"
#include "tests/support/fake_clock.h"
#include "tests/support/meshes.h"
#include "tests/support/poses.h"

namespace arap::app {
namespace {

using std::chrono::seconds;
using testing::AtVertex;
using testing::Square;

class AppTest : public ::testing::Test {
 protected:
  std::shared_ptr<Session> Open(const std::string& id, seconds ttl = seconds(60)) {
    EXPECT_TRUE(engine_.sessions.Create(ann_, {id, ttl, {}}));
    return *engine_.sessions.Use("ann", id);
  }
  Result<Registration> Register(const std::string& session, const std::string& mesh,
                                const EnergyOptions& options = {}, const CancelToken& cancel = {}) {
    return RegisterMesh(engine_, ann_, session, mesh, Square(), options, cancel);
  }
  Result<HandleSetEntry> Compile(const std::string& set, const std::vector<Handle>& handles,
                                 const CancelToken& cancel = {}) {
    return CompileHandles(engine_, ann_, "s", "m", set, handles, cancel);
  }
  bool IsKept(const std::string& hash) { return engine_.derived.Has(MeshKey("ann", hash)); }

  runtime::FakeClock clock_;
  const Caller ann_{"ann", Role::kUser, {}};
  Engine engine_{Limits{}, Lanes{1, 1}, clock_, *store::OpenStores({})};
};

TEST_F(AppTest, EndOfASessionIsToldOnce) {
  auto session = Open("s");
  int told = 0;
  int removed = 0;
  session->AddEndListener([&] { ++told; });
  session->RemoveEndListener(session->AddEndListener([&] { ++removed; }));
  ASSERT_TRUE(engine_.sessions.Delete("ann", "s"));
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
  EXPECT_TRUE(engine_.sessions.List("ann", 0, "")->sessions.empty());
  EXPECT_EQ(told, 1);
  EXPECT_FALSE(session->Touch()) << "an expired session does not come back";
}

TEST_F(AppTest, EndedSessionTakesNothing) {
  auto session = Open("s");
  ASSERT_TRUE(engine_.sessions.Delete("ann", "s"));
  const auto changed = engine_.sessions.Change(ann_, *session, [](store::SessionRecord& record) {
    record.meshes["m"] = {"0"};
    return Result<bool>(true);
  });
  ASSERT_FALSE(changed);
  EXPECT_EQ(changed.error().kind, FaultKind::kNotFound);
}

TEST_F(AppTest, DeletedSessionsFreeTheirMeshes) {
  Open("s");
  Open("t");
  const auto first = Register("s", "m");
  ASSERT_TRUE(first);
  const auto second = Register("t", "m");
  ASSERT_TRUE(second);
  EXPECT_EQ(first->entry.mesh, second->entry.mesh);
  const std::weak_ptr<const RegisteredMesh> mesh = first->entry.mesh;
  const std::string hash = first->entry.content_hash;
  ASSERT_TRUE(engine_.sessions.Delete("ann", "s"));
  EXPECT_TRUE(IsKept(hash)) << "the other session has it";
  ASSERT_TRUE(engine_.sessions.Delete("ann", "t"));
  EXPECT_FALSE(IsKept(hash));
  EXPECT_FALSE(mesh.expired()) << "running work still holds it";
  EXPECT_EQ(engine_.derived.bytes() - engine_.sessions.bytes(), mesh.lock()->report().bytes)
      << "and it still counts";
}

TEST_F(AppTest, DeletedMeshIsFreed) {
  Open("s");
  std::weak_ptr<const RegisteredMesh> mesh;
  std::string hash;
  {
    const auto registration = Register("s", "m");
    ASSERT_TRUE(registration);
    mesh = registration->entry.mesh;
    hash = registration->entry.content_hash;
  }
  ASSERT_TRUE(Compile("h", {AtVertex("a", 0)}));
  EXPECT_FALSE(mesh.expired());
  ASSERT_TRUE(DeleteMesh(engine_, ann_, "s", "m"));
  EXPECT_TRUE(mesh.expired());
  EXPECT_FALSE(IsKept(hash));
  EXPECT_EQ(engine_.derived.bytes() - engine_.sessions.bytes(), 0u);
}

TEST_F(AppTest, OptionsAreContentToo) {
  Open("s");
  const auto edge = Register("s", "m");
  const auto face = Register("s", "n", {Basis::kFace, {}, {}});
  const auto rigid = Register("s", "o", {{}, {}, {1, 2}});
  ASSERT_TRUE(edge && face && rigid);
  EXPECT_NE(edge->entry.content_hash, face->entry.content_hash);
  EXPECT_NE(edge->entry.content_hash, rigid->entry.content_hash);
}

TEST_F(AppTest, CancelledWorkKeepsNothing) {
  auto session = Open("s");
  const CancelToken cancelled(
      [] { return Status(Fail(FaultKind::kCancelled, "The caller has cancelled.")); });
  const auto mesh = Register("s", "m", {}, cancelled);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().kind, FaultKind::kCancelled);
  EXPECT_FALSE(FindMesh(*session->record(), "m"));
  ASSERT_TRUE(Register("s", "m"));
  const auto set = Compile("h", {AtVertex("a", 0)}, cancelled);
  ASSERT_FALSE(set);
  EXPECT_EQ(set.error().kind, FaultKind::kCancelled);
  EXPECT_FALSE(FindHandleSet(*session->record(), "h"));
}

TEST_F(AppTest, EditsThatMeetAreDoneOneOnTheOther) {
  auto session = Open("s");
  ASSERT_TRUE(Register("s", "m"));
  ASSERT_TRUE(Compile("h", {AtVertex("a", 0)}));
  // While one is being compiled another one is stored: on the first question, once.
  bool interfered = false;
  const CancelToken other([&] {
    if (!std::exchange(interfered, true)) {
      EXPECT_TRUE(EditHandles(engine_, ann_, "s", "h", {}, {AtVertex("b", 1)}, {}));
    }
    return Status{};
  });
  const auto both = EditHandles(engine_, ann_, "s", "h", {}, {AtVertex("c", 2)}, other);
  ASSERT_TRUE(both);
  EXPECT_TRUE(interfered);
  EXPECT_EQ(both->revision, 3u);
  EXPECT_EQ(both->handles->handles().size(), 3u);
  EXPECT_EQ(FindHandleSet(*session->record(), "h")->definitions->size(), 3u);
}

}  // namespace
}  // namespace arap::app
