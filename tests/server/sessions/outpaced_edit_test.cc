// Two servers edit a handle set at once: the one whose record comes second has to do its edit again,
// on what the other one has left.
#include <functional>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "server/engine.h"
#include "server/sessions/handle_sets.h"
#include "server/sessions/meshes.h"
#include "server/store/memory_store.h"
#include "tests/support/fake_clock.h"
#include "tests/support/meshes.h"
#include "tests/support/poses.h"

namespace arap::app {
namespace {

// Another server changes the record just before the next Put.
class OutpacedStore : public store::MemorySpecStore {
 public:
  using Change = std::function<void(store::SessionRecord&)>;

  void BeforeTheNextPut(Change change) { change_ = std::move(change); }

  Result<bool> Put(const store::SessionRecord& record) override {
    if (const Change change = std::exchange(change_, nullptr)) {
      store::SessionRecord theirs = **MemorySpecStore::Load(record.key);
      change(theirs);
      ++theirs.revision;
      EXPECT_EQ(MemorySpecStore::Put(theirs), true);
    }
    return MemorySpecStore::Put(record);
  }

 private:
  Change change_;
};

class OutpacedEditTest : public ::testing::Test {
 protected:
  OutpacedEditTest() {
    auto stores = *store::OpenStores({});
    auto specs = std::make_unique<OutpacedStore>();
    store_ = specs.get();
    stores.specs = std::move(specs);
    engine_.emplace(Limits{}, Lanes{1, 1}, clock_, std::move(stores));
  }
  void SetUp() override {
    ASSERT_TRUE(engine_->sessions.Create(ann_, {"s", std::chrono::minutes(1), {}}));
    ASSERT_TRUE(RegisterMesh(*engine_, ann_, "s", "m", testing::JitteredGrid(6, 6, 3), {}, {}));
    ASSERT_TRUE(CompileHandles(*engine_, ann_, "s", "m", "h", {Named("first", 0)}, {}));
  }

  static Handle Named(const char* id, std::uint32_t vertex) {
    Handle handle = testing::AtVertex(vertex);
    handle.id = id;
    return handle;
  }
  static void AddTheirs(store::SessionRecord& record) {
    store::HandleSetRecord& set = record.handle_sets.at("h");
    std::vector<Handle> handles = *set.definitions;
    handles.push_back(Named("theirs", 5));
    set.definitions = store::MakeDefinitions(std::move(handles));
    ++set.revision;
  }
  std::vector<std::string> StoredHandles() {
    std::vector<std::string> ids;
    const auto record = store_->Load({"ann", "s"});
    for (const Handle& handle : *(*record)->handle_sets.at("h").definitions) {
      ids.push_back(handle.id);
    }
    return ids;
  }

  const Caller ann_{"ann", Role::kUser, {}};
  runtime::FakeClock clock_;
  OutpacedStore* store_ = nullptr;
  std::optional<Engine> engine_;
};

TEST_F(OutpacedEditTest, IsDoneOnWhatTheOtherHasLeft) {
  store_->BeforeTheNextPut(&AddTheirs);
  const auto edited = EditHandles(*engine_, ann_, "s", "h", {}, {Named("ours", 7)}, {});
  ASSERT_TRUE(edited) << edited.error().message;
  EXPECT_EQ(edited->revision, 3u);
  EXPECT_EQ(StoredHandles(), (std::vector<std::string>{"first", "theirs", "ours"}));
  EXPECT_EQ(edited->handles->handles().size(), 3u);
}

TEST_F(OutpacedEditTest, WhatTheOtherHasTakenAwayIsNotThere) {
  store_->BeforeTheNextPut([](store::SessionRecord& record) { record.handle_sets.erase("h"); });
  const auto edited = EditHandles(*engine_, ann_, "s", "h", {}, {Named("ours", 7)}, {});
  ASSERT_FALSE(edited);
  EXPECT_EQ(edited.error().kind, FaultKind::kNotFound);
}

}  // namespace
}  // namespace arap::app
