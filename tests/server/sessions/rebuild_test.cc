// What was computed is evicted, rebuilt, survives its process, and belongs to its owner.
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "arap/core/deformer.h"
#include "server/engine.h"
#include "server/sessions/handle_sets.h"
#include "server/sessions/meshes.h"
#include "tests/support/fake_clock.h"
#include "tests/support/meshes.h"
#include "tests/support/poses.h"

namespace arap::app {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;
using testing::AtVertex;

PlanarMesh Mesh() { return testing::JitteredGrid(12, 9, 7); }

std::vector<Handle> AtVertices(const std::vector<std::uint32_t>& vertices) {
  std::vector<Handle> handles;
  for (const std::uint32_t vertex : vertices) handles.push_back(AtVertex(vertex));
  return handles;
}

TEST(MeshBlobTest, RepairsAreKeptAndMeshesWithoutAreAsTheyWere) {
  const PlanarMesh mesh = Mesh();
  const EnergyOptions options{Basis::kFace, Weights::kCotangent, {}};
  const std::string plain = EncodeMesh(mesh, options);
  EXPECT_TRUE(plain.starts_with("arap planar mesh 1\n"));
  EXPECT_EQ(EncodeMesh(mesh, options, {}), plain);
  const RepairOptions all[] = {{.weld = true},
                               {.drop_duplicates = true},
                               {.stitch = true},
                               {.tolerance = 0},
                               {.weld = true, .stitch = true, .tolerance = 1e-3}};
  for (const RepairOptions& repairs : all) {
    const std::string bytes = EncodeMesh(mesh, options, repairs);
    EXPECT_NE(bytes, plain);
    const auto blob = DecodeMesh(bytes);
    ASSERT_TRUE(blob);
    EXPECT_EQ(blob->repairs, repairs);
    EXPECT_EQ(blob->options, options);
    EXPECT_EQ(blob->mesh, mesh);
    EXPECT_FALSE(DecodeMesh(bytes.substr(0, 40)));
  }
}

class WarmTest : public ::testing::Test {
 protected:
  WarmTest() { Start(*store::OpenStores({})); }

  void Start(store::Stores stores) {
    engine_ = std::make_unique<Engine>(limits_, Lanes{1, 1, 1}, clock_, std::move(stores));
  }
  void Open(const Caller& caller, const std::string& id) {
    ASSERT_TRUE(engine_->sessions.Create(caller, {id, minutes(60), {}}));
  }
  Result<Registration> Register(const Caller& caller, const std::string& session,
                                const std::string& mesh, const EnergyOptions& options = {}) {
    return RegisterMesh(*engine_, caller, session, mesh, Mesh(), options, {});
  }
  std::shared_ptr<Session> Use(const Caller& caller, const std::string& session) {
    auto used = engine_->sessions.Use(caller.owner, session);
    EXPECT_TRUE(used);
    return *used;
  }
  // The shape for targets that depend on the handle alone.
  std::vector<Complex> Shape(const Caller& caller, const std::string& session,
                             const std::string& set) {
    auto entry = WarmHandleSet(*engine_, caller, *Use(caller, session), set, {});
    EXPECT_TRUE(entry) << entry.error().message;
    std::vector<Target> targets = entry->handles->RestTargets();
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const auto n = static_cast<double>(i);
      targets[i].position *= std::polar(1.1, 0.2 + 0.1 * n);
    }
    Deformer deformer(entry->handles);
    EXPECT_TRUE(deformer.Update(targets, {.mode = DeformMode::kRigid, .refine = 1}));
    return {deformer.positions().begin(), deformer.positions().end()};
  }

  runtime::FakeClock clock_;
  Limits limits_;
  const Caller ann_{"ann", Role::kUser, {}};
  const Caller ben_{"ben", Role::kUser, {}};
  std::unique_ptr<Engine> engine_;
};

TEST_F(WarmTest, WhatWasEvictedComesBackWithTheSameBytes) {
  for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace, Basis::kVertex}) {
    for (const Weights weights : {Weights::kUniform, Weights::kCotangent}) {
      const std::string id =
          "s" + std::to_string(static_cast<int>(basis)) + std::to_string(static_cast<int>(weights));
      Open(ann_, id);
      ASSERT_TRUE(Register(ann_, id, "m", {basis, weights, {}}));
      ASSERT_TRUE(
          CompileHandles(*engine_, ann_, id, "m", "h", AtVertices({0, 17, 40, 63, 80}), {}));
      ASSERT_TRUE(
          EditHandles(*engine_, ann_, id, "h", {"v17", "v80"}, AtVertices({5, 77, 99}), {}));
      ASSERT_TRUE(EditHandles(*engine_, ann_, id, "h", {"v5"}, AtVertices({31}), {}));
      const std::vector<Complex> before = Shape(ann_, id, "h");
      engine_->derived.EvictIdle(seconds(0));
      EXPECT_EQ(engine_->derived.bytes() - engine_->sessions.bytes(), 0u);
      EXPECT_FALSE(PeekHandleSet(*engine_, *Use(ann_, id), "h").warmth == Warmth::kWarm);
      EXPECT_FALSE(PeekMesh(*engine_, *Use(ann_, id), "m").warmth == Warmth::kWarm);
      EXPECT_EQ(Shape(ann_, id, "h"), before) << id;
      EXPECT_TRUE(PeekHandleSet(*engine_, *Use(ann_, id), "h").warmth == Warmth::kWarm);
    }
  }
}

TEST_F(WarmTest, IdleMemoryComesBackAndTheSessionLivesOn) {
  Open(ann_, "s");
  ASSERT_TRUE(Register(ann_, "s", "m"));
  ASSERT_TRUE(CompileHandles(*engine_, ann_, "s", "m", "h", AtVertices({0, 80}), {}));
  const std::vector<Complex> before = Shape(ann_, "s", "h");
  clock_.Advance(limits_.idle_evict - seconds(1));
  ASSERT_TRUE(engine_->Sweep());
  EXPECT_GT(engine_->derived.bytes(DerivedKind::kMesh), 0u);
  clock_.Advance(seconds(1));
  ASSERT_TRUE(engine_->Sweep());
  EXPECT_EQ(engine_->derived.bytes(DerivedKind::kHandleSet), 0u);
  clock_.Advance(limits_.idle_evict);
  ASSERT_TRUE(engine_->Sweep());
  EXPECT_EQ(engine_->derived.bytes() - engine_->sessions.bytes(), 0u)
      << "the mesh, which the set held, a while later";
  EXPECT_EQ(Shape(ann_, "s", "h"), before);
}

TEST_F(WarmTest, ASetThatAnotherServerHasChangedIsNotWarm) {
  Open(ann_, "s");
  ASSERT_TRUE(Register(ann_, "s", "m"));
  ASSERT_TRUE(CompileHandles(*engine_, ann_, "s", "m", "h", AtVertices({0, 80}), {}));
  const auto session = Use(ann_, "s");
  EXPECT_TRUE(PeekHandleSet(*engine_, *session, "h").warmth == Warmth::kWarm);
  ASSERT_TRUE(
      engine_->sessions.Change(ann_, *session, [](store::SessionRecord& record) -> Result<bool> {
        record.handle_sets.at("h").definitions = store::MakeDefinitions(AtVertices({0, 17}));
        return true;
      }));
  EXPECT_FALSE(PeekHandleSet(*engine_, *session, "h").warmth == Warmth::kWarm);
}

// A frame of one set must not cost what the set has in handles.
TEST_F(WarmTest, AWarmSetSharesItsDefinitions) {
  Open(ann_, "s");
  ASSERT_TRUE(Register(ann_, "s", "m"));
  ASSERT_TRUE(CompileHandles(*engine_, ann_, "s", "m", "h", AtVertices({0, 80}), {}));
  const auto session = Use(ann_, "s");
  const auto stored = [&] { return session->record()->handle_sets.at("h").definitions; };
  EXPECT_EQ(WarmHandleSet(*engine_, ann_, *session, "h", {})->definitions, stored());
  // Read again from the store because something else has changed.
  const auto before = stored();
  auto record = **engine_->stores.specs->Load({"ann", "s"});
  record.handle_sets.at("h").definitions = store::MakeDefinitions(AtVertices({0, 80}));
  session->Reload(std::move(record), {});
  EXPECT_EQ(stored(), before) << "the same list, not an equal one";
}

TEST_F(WarmTest, WhatAStreamHoldsIsNotEvicted) {
  Open(ann_, "s");
  ASSERT_TRUE(Register(ann_, "s", "m"));
  ASSERT_TRUE(CompileHandles(*engine_, ann_, "s", "m", "h", AtVertices({0, 80}), {}));
  auto entry = WarmHandleSet(*engine_, ann_, *Use(ann_, "s"), "h", {});
  ASSERT_TRUE(entry);
  clock_.Advance(limits_.idle_evict);
  EXPECT_EQ(engine_->derived.EvictIdle(limits_.idle_evict), 0u);
  entry->handles = nullptr;
  EXPECT_EQ(engine_->derived.EvictIdle(limits_.idle_evict), 0u) << "it was in use just now";
}

TEST_F(WarmTest, OwnersShareNothing) {
  for (const Caller& caller : {ann_, ben_}) Open(caller, "s");
  const auto first = Register(ann_, "s", "m");
  const auto again = Register(ann_, "s", "n");
  const auto other = Register(ben_, "s", "m");
  ASSERT_TRUE(first && again && other);
  EXPECT_TRUE(again->shared);
  EXPECT_EQ(again->entry.mesh, first->entry.mesh) << "counted once";
  const std::size_t record = BytesOf(*engine_->sessions.Use("ann", "s").value()->record());
  EXPECT_EQ(engine_->derived.bytes_of("ann") - record, first->entry.mesh->report().bytes);
  EXPECT_FALSE(other->shared) << "that somebody else has it must not show";
  ASSERT_TRUE(engine_->sessions.Delete("ann", "s"));
  EXPECT_TRUE(engine_->sessions.Use("ben", "s"));
  EXPECT_FALSE(engine_->sessions.Use("ann", "s"));
}

TEST_F(WarmTest, MemoryIsGrantedBeforeItIsTaken) {
  Caller small = ann_;
  small.limits.max_bytes = 1000;
  Open(small, "s");
  const auto refused = Register(small, "s", "m");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, FaultKind::kLimitExceeded);
  EXPECT_EQ(refused.error().details.front().second, "max_bytes_per_owner");
  EXPECT_EQ(engine_->derived.bytes() - engine_->sessions.bytes(), 0u);
  EXPECT_TRUE(Register(ann_, "s", "m"));
}

TEST_F(WarmTest, OthersIdleDataMakesRoom) {
  Open(ann_, "s");
  Open(ben_, "s");
  ASSERT_TRUE(Register(ann_, "s", "m"));
  const std::size_t one = engine_->derived.bytes() - engine_->sessions.bytes();
  const std::size_t asked = limits_.max_bytes - one + 1;
  Caller greedy = ben_;
  greedy.limits.max_bytes = limits_.max_bytes;
  {
    const auto held = *Register(ann_, "s", "m");
    EXPECT_FALSE(engine_->derived.Reserve(greedy, asked)) << "in use";
  }
  auto room = engine_->derived.Reserve(greedy, asked);
  ASSERT_TRUE(room);
  EXPECT_FALSE(PeekMesh(*engine_, *Use(ann_, "s"), "m").warmth == Warmth::kWarm);
  room->Release();
  EXPECT_EQ(engine_->derived.bytes() - engine_->sessions.bytes(), 0u);
}

TEST_F(WarmTest, OwnersHaveQuotas) {
  Caller small = ann_;
  small.limits = {.max_sessions = 2, .max_meshes = 1, .max_handle_sets = 1};
  Open(small, "s");
  Open(small, "t");
  const auto quota = [](const auto& result) {
    EXPECT_FALSE(result);
    EXPECT_EQ(result.error().kind, FaultKind::kLimitExceeded);
    return result.error().details.front().second;
  };
  EXPECT_EQ(quota(engine_->sessions.Create(small, {"u", minutes(1), {}})),
            "max_sessions_per_owner");
  EXPECT_TRUE(engine_->sessions.Create(ben_, {"u", minutes(1), {}}));
  ASSERT_TRUE(Register(small, "s", "m"));
  EXPECT_EQ(quota(Register(small, "t", "m")), "max_meshes_per_owner");
  ASSERT_TRUE(CompileHandles(*engine_, small, "s", "m", "h", AtVertices({0, 1}), {}));
  EXPECT_EQ(quota(CompileHandles(*engine_, small, "s", "m", "i", AtVertices({0, 1}), {})),
            "max_handle_sets_per_owner");
}

TEST_F(WarmTest, BytesInTheStoreAreTheOwners) {
  Open(ann_, "s");
  Open(ann_, "t");
  Caller poor = ann_;
  poor.limits.max_stored_bytes = 500;
  EXPECT_FALSE(Register(poor, "s", "m"));
  EXPECT_EQ(engine_->keeper.Collect({seconds(0), seconds(0)})->removed, 0u)
      << "what is refused does not even reach the disk";
  ASSERT_TRUE(Register(ann_, "s", "m"));
  const std::size_t used = engine_->stores.specs->UsageOf("ann")->bytes;
  ASSERT_GT(used, 1'000u);
  Caller small = ann_;
  const auto refused = [&](std::size_t limit) {
    small.limits.max_stored_bytes = limit;
    const auto result = Register(small, "t", "m");
    EXPECT_FALSE(result);
    if (result) return FaultKind::kInternal;
    EXPECT_NE(result.error().message.find("max_stored_bytes_per_owner"), std::string::npos)
        << result.error().message;
    return result.error().kind;
  };
  EXPECT_EQ(refused(used + 100), FaultKind::kLimitExceeded) << "in the other session, too";
  EXPECT_EQ(refused(100), FaultKind::kLimitExceeded) << "never";
  ASSERT_TRUE(DeleteMesh(*engine_, small, "s", "m"));
  small.limits.max_stored_bytes = used + 100;
  EXPECT_TRUE(Register(small, "t", "m"));
}

TEST_F(WarmTest, UnnamedBlobsAreCollected) {
  Open(ann_, "s");
  ASSERT_TRUE(Register(ann_, "s", "m"));
  EXPECT_EQ(engine_->keeper.Collect({seconds(0), seconds(0)})->kept, 1u);
  ASSERT_TRUE(DeleteMesh(*engine_, ann_, "s", "m"));
  EXPECT_EQ(engine_->keeper.Collect({minutes(10), seconds(0)})->kept, 1u) << "too young to judge";
  EXPECT_EQ(engine_->keeper.Collect({seconds(0), seconds(0)})->removed, 1u);
}

TEST_F(WarmTest, ExpiryIsStoredBeforeItIsOvertaken) {
  Open(ann_, "s");
  store::SpecStore& specs = *engine_->stores.specs;
  const auto stored = [&] { return (*specs.Load({"ann", "s"}))->expires; };
  const auto told = [&] { return Use(ann_, "s")->View().expires; };
  for (int i = 0; i < 100; ++i) {
    EXPECT_GE(stored(), told()) << "a crash must not shorten a life";
    clock_.Advance(seconds(9));
    Use(ann_, "s");
    ASSERT_TRUE(engine_->Sweep());
  }
  clock_.Advance(minutes(60));
  ASSERT_TRUE(engine_->Sweep());
  EXPECT_FALSE(*specs.Load({"ann", "s"}));
}

}  // namespace
}  // namespace arap::app
