// What keeps what is stored from harm: whose blobs they are, too many at once, clocks that differ.
#include "server/store/store_keeper.h"

#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/token/digest.h"
#include "server/store/memory_store.h"
#include "tests/server/store/records.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/store_kind.h"
#include "tests/server/store/temp_dir.h"
#include "tests/support/fake_clock.h"

namespace arap::store {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

std::set<std::string> ReasonsOf(const StoreKeeper& keeper) {
  std::set<std::string> reasons;
  for (const Weakness& weakness : keeper.weaknesses()) reasons.insert(weakness.reason);
  return reasons;
}

// Blobs that nobody names, three hours old.
class KeeperTest : public ::testing::Test {
 protected:
  Result<Stores> Open(const std::string& store) {
    StoreOptions options;
    options.store = store;
    options.blob_dir = dir_ / "blobs";
    return OpenStores(options);
  }
  std::string Put(Stores& stores, int number) {
    const std::string bytes = "blob " + std::to_string(number);
    const std::string hash = *Sha256Hex(bytes);
    EXPECT_TRUE(stores.blobs->Put(hash, bytes));
    const std::string path =
        dir_ / "blobs/" + hash.substr(0, 2) + "/" + hash.substr(2, 2) + "/" + hash;
    fs::last_write_time(path, fs::file_time_type::clock::now() - hours(3));
    return hash;
  }

  testing::TempDir dir_;
  runtime::FakeClock clock_;
};

TEST_F(KeeperTest, AnEmptiedRedisTakesNoBlobWithIt) {
  testing::RedisServer redis;
  auto stores = Open(redis.Url());
  ASSERT_TRUE(stores) << stores.error().message;
  SessionRecord record = testing::PlainRecord("ann", "s");
  for (int i = 0; i < 3; ++i) record.meshes[std::to_string(i)] = {Put(*stores, i), 6};
  ASSERT_EQ(stores->specs->Put(record), true);
  StoreKeeper keeper(*stores->specs, *stores->blobs, clock_, false);
  EXPECT_EQ(keeper.Collect(kSweepRules)->kept, 3u);

  testing::RawRedis(redis.Url(), {"FLUSHALL"});
  EXPECT_EQ(keeper.Collect({seconds(0), seconds(0)})->removed, 0u) << "by no rules";
  for (const auto& [id, mesh] : record.meshes) {
    if (mesh.bytes > 0) {
      EXPECT_TRUE(stores->blobs->Get(mesh.blob)) << id;
    }
  }
  clock_.Advance(minutes(1));
  ASSERT_TRUE(keeper.Look());
  EXPECT_TRUE(ReasonsOf(keeper).contains("foreign_blobs"));
}

TEST_F(KeeperTest, ManyAtOnceAreHeldBackForAnHourAndTold) {
  auto stores = Open("sqlite:" + (dir_ / "state"));
  ASSERT_TRUE(stores);
  for (int i = 0; i < 80; ++i) Put(*stores, i);
  StoreKeeper keeper(*stores->specs, *stores->blobs, clock_, false);
  for (int minute = 0; minute < 60; minute += 10) {
    const auto report = keeper.Collect(kSweepRules);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->held_back, 80u);
    EXPECT_EQ(report->kept, 80u);
    ASSERT_EQ(keeper.weaknesses().size(), 1u);
    EXPECT_FALSE(keeper.weaknesses()[0].grave);
    EXPECT_NE(keeper.weaknesses()[0].sentence.find("80 of 80"), std::string::npos);
    clock_.Advance(minutes(10));
  }
  const auto report = keeper.Collect(kSweepRules);
  EXPECT_EQ(report->aside, 80u);
  EXPECT_EQ(report->removed, 0u) << "they can be brought back for a day";
  EXPECT_TRUE(keeper.weaknesses().empty());
}

TEST_F(KeeperTest, AClockThatDiffersIsGraveAndAStoreThatForgetsMayBeAllowed) {
  testing::RedisServer redis;
  testing::RedisWithFakeTime specs(redis, clock_);
  MemoryBlobStore blobs;
  runtime::FakeClock ours;
  StoreKeeper keeper(specs, blobs, ours, false), lenient(specs, blobs, ours, true);
  ASSERT_TRUE(keeper.Look());
  EXPECT_TRUE(keeper.weaknesses().empty());
  ours.SetBy(hours(2));
  ours.Advance(minutes(1));
  clock_.Advance(minutes(1));
  testing::RawRedis(redis.Url(), {"CONFIG", "SET", "appendonly", "no"});
  ASSERT_TRUE(keeper.Look());
  ASSERT_TRUE(lenient.Look());
  EXPECT_EQ(ReasonsOf(keeper), (std::set<std::string>{"clock_skew", "forgets"}));
  for (const Weakness& weakness : keeper.weaknesses()) EXPECT_TRUE(weakness.grave);
  for (const Weakness& weakness : lenient.weaknesses()) {
    EXPECT_EQ(weakness.grave, weakness.reason == std::string("clock_skew"));
    if (weakness.grave) {
      EXPECT_EQ(weakness.sentence,
                "The clock of this server is 7200 s ahead of that of the store.");
    }
  }
  ours.SetBy(hours(-2));
  ours.Advance(minutes(1));
  clock_.Advance(minutes(1));
  ASSERT_TRUE(keeper.Look());
  EXPECT_FALSE(ReasonsOf(keeper).contains("clock_skew"));
}

TEST_F(KeeperTest, WhileTheStoreIsAwayNothingIsTakenAway) {
  testing::RedisServer redis;
  auto stores = Open(redis.Url());
  ASSERT_TRUE(stores);
  const std::string hash = Put(*stores, 1);
  StoreKeeper keeper(*stores->specs, *stores->blobs, clock_, false);
  redis.Kill();
  EXPECT_EQ(keeper.Look().error().kind, FaultKind::kStoreUnavailable);
  EXPECT_EQ(keeper.Collect({seconds(0), seconds(0)}).error().kind, FaultKind::kStoreUnavailable);
  EXPECT_TRUE(stores->blobs->Get(hash));
}

}  // namespace
}  // namespace arap::store
