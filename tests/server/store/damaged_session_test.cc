// A session whose stored record cannot be read: it is in nobody's way, and not there for ever.
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "server/sessions/session_registry.h"
#include "server/store/open_store.h"
#include "server/store/redis/redis.h"
#include "server/store/sqlite/sqlite.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/store_kind.h"
#include "tests/server/store/temp_dir.h"
#include "tests/support/fake_clock.h"

namespace arap::app {
namespace {

using std::chrono::minutes;
using testing::StoreKind;

// The sessions "a", "b" and "c" of ann, of which "b" lives a minute.
class DamagedSession : public ::testing::Test {
 protected:
  void Start(StoreKind kind) {
    if (kind == StoreKind::kRedis) redis_.emplace();
    Open();
    for (const char* id : {"a", "b", "c"}) ASSERT_TRUE(Create(id));
  }
  void Open() {
    store::StoreOptions options;
    options.store = redis_ ? redis_->Url() : "sqlite:" + (dir_ / "state");
    options.blob_dir = dir_ / "blobs";
    auto stores = store::OpenStores(options);
    ASSERT_TRUE(stores) << stores.error().message;
    stores_ = *std::move(stores);
    if (redis_) stores_.specs = std::make_unique<testing::RedisWithFakeTime>(*redis_, clock_);
    sessions_.emplace(limits_, clock_, *stores_.specs, memory_, [](const store::SessionRecord&) {});
  }
  void Close() {
    sessions_.reset();
    stores_ = {};
  }

  // To another revision, so that servers with shared records notice.
  void DamageInRedis() const {
    const auto reply = testing::RawRedis(
        redis_->Url(), {"HSET", "arap:session:3:ann:b", "revision", "7", "record", "nonsense"});
    ASSERT_FALSE(reply.IsError());
  }
  void DamageInSqlite() const {
    auto database =
        store::Sqlite::Open(dir_ / "state/sessions.db", store::Sqlite::Missing::kRefuse);
    ASSERT_TRUE(database);
    ASSERT_EQ(database->Run("UPDATE sessions SET record = 'nonsense' WHERE id = 'b'"), SQLITE_OK);
  }

  Result<SessionView> Create(const std::string& id) {
    return sessions_->Create(ann_, {id, minutes(id == "b" ? 1 : 60), {}});
  }
  Status Delete(const std::string& id) { return sessions_->Delete("ann", id); }
  // One after the other; a failure of the test when they are not to be had.
  std::string List() {
    const auto page = sessions_->List("ann", 0, "");
    EXPECT_TRUE(page) << page.error().message;
    std::string ids;
    if (page) {
      for (const SessionView& view : page->sessions) ids += view.spec.id;
    }
    return ids;
  }
  template <class T>
  static FaultKind KindOf(const T& result) {
    EXPECT_FALSE(result);
    return result ? FaultKind::kInternal : result.error().kind;
  }

  const Caller ann_{"ann", Role::kUser, {}};
  const Limits limits_{};
  runtime::FakeClock clock_;
  DerivedCache memory_{limits_.max_bytes, {}, clock_};
  testing::TempDir dir_;
  std::optional<testing::RedisServer> redis_;
  store::Stores stores_;
  std::optional<SessionRegistry> sessions_;
};

// Found by a server that has just started.
class DamagedSessionAtRest : public DamagedSession,
                             public ::testing::WithParamInterface<StoreKind> {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(Start(GetParam()));
    Close();
    ASSERT_NO_FATAL_FAILURE(redis_ ? DamageInRedis() : DamageInSqlite());
    ASSERT_NO_FATAL_FAILURE(Open());
    ASSERT_EQ(KindOf(sessions_->View("ann", "b")), FaultKind::kDataLoss);
  }
};

INSTANTIATE_TEST_SUITE_P(Stores, DamagedSessionAtRest,
                         ::testing::Values(StoreKind::kSqlite, StoreKind::kRedis),
                         ::testing::PrintToStringParamName());

TEST_P(DamagedSessionAtRest, OthersGoOnAndItsIdIsNotTakenUnawares) {
  EXPECT_EQ(List(), "ac");
  EXPECT_TRUE(sessions_->Use("ann", "a"));
  EXPECT_EQ(KindOf(sessions_->Use("ann", "b")), FaultKind::kDataLoss);
  EXPECT_EQ(KindOf(Create("b")), FaultKind::kDataLoss);
  EXPECT_TRUE(sessions_->Sweep());
}

TEST_P(DamagedSessionAtRest, CanBeDeletedAndMadeAnew) {
  EXPECT_TRUE(Delete("b"));
  EXPECT_EQ(KindOf(Delete("b")), FaultKind::kNotFound);
  EXPECT_EQ(stores_.specs->UsageOf("ann")->sessions, 2u);
  EXPECT_TRUE(Create("b"));
  EXPECT_EQ(List(), "abc");
}

TEST_P(DamagedSessionAtRest, GoesWhenItExpires) {
  clock_.Advance(minutes(2));
  EXPECT_TRUE(sessions_->Sweep());
  EXPECT_EQ(stores_.specs->UsageOf("ann")->sessions, 2u);
  EXPECT_TRUE(Create("b"));
}

// Found by a server that has the session in memory.
class DamagedSessionInUse : public DamagedSession {
 protected:
  void SetUp() override { ASSERT_NO_FATAL_FAILURE(Start(StoreKind::kRedis)); }
};

TEST_F(DamagedSessionInUse, EndsForItsStreamsWhenItIsDeleted) {
  int told = 0;
  (*sessions_->Use("ann", "b"))->AddEndListener([&] { ++told; });
  DamageInRedis();
  EXPECT_EQ(KindOf(sessions_->Use("ann", "b")), FaultKind::kDataLoss);
  EXPECT_TRUE(Delete("b"));
  EXPECT_EQ(told, 1);
  EXPECT_EQ(sessions_->in_memory(), 2u);
  EXPECT_TRUE(Create("b"));
}

TEST_F(DamagedSessionInUse, IsInNobodysWayWhenItExpires) {
  DamageInRedis();
  clock_.Advance(minutes(2));
  EXPECT_EQ(List(), "ac");
  EXPECT_TRUE(sessions_->Sweep());
  EXPECT_EQ(sessions_->in_memory(), 2u);
  EXPECT_TRUE(Create("b"));
}

}  // namespace
}  // namespace arap::app
