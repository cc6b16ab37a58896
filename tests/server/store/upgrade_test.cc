// What released versions have stored: this one reads it, and goes on from there.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "server/sessions/meshes.h"
#include "server/store/open_store.h"
#include "server/store/sqlite/sqlite.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/store_kind.h"
#include "tests/server/store/temp_dir.h"

namespace arap::store {
namespace {

namespace fs = std::filesystem;

const std::string kReleased = ARAP_RELEASED;

Result<Stores> Open(const std::string& store, const std::string& blob_dir = "") {
  StoreOptions options;
  options.store = store;
  options.blob_dir = blob_dir;
  return OpenStores(options);
}

// A session of the load generator: one mesh of 25 vertices, one set of three handles.
void ExpectAsReleased(Stores& stores, const SessionRecord& record) {
  EXPECT_EQ(record.key.owner, "anonymous");
  EXPECT_EQ(record.revision, 3u);
  EXPECT_EQ(record.incarnation, "");
  EXPECT_EQ(record.ttl, std::chrono::hours(1));
  ASSERT_EQ(record.meshes.size(), 1u);
  ASSERT_EQ(record.handle_sets.size(), 1u);
  const HandleSetRecord& set = record.handle_sets.at("load");
  ASSERT_EQ(set.definitions->size(), 3u);
  EXPECT_EQ(set.definitions->front().id, "h0");
  EXPECT_EQ(std::get<PointAnchor>(set.definitions->front().anchor).position,
            Complex(2.7348469228349535, 2.0));
  const auto bytes = stores.blobs->Get(record.meshes.begin()->second.blob);
  ASSERT_TRUE(bytes);
  const auto mesh = app::DecodeMesh(*bytes);
  ASSERT_TRUE(mesh);
  EXPECT_GT(mesh->mesh.triangles.size(), 20u);
}

void ExpectToGoOn(Stores& stores, const SessionRecord& old) {
  SessionRecord changed = old;
  ++changed.revision;
  changed.labels["after"] = "the upgrade";
  EXPECT_EQ(stores.specs->Put(changed), true);
  EXPECT_EQ((*stores.specs->Load(old.key))->labels, changed.labels);
  EXPECT_EQ(stores.specs->Extend(old.key, "", old.expires + std::chrono::hours(1)), true);
  EXPECT_EQ(stores.specs->Remove(old.key), true);
}

TEST(UpgradeTest, TheDirectoryOf0_1_0) {
  const testing::TempDir dir;
  const std::string state = dir / "state";
  fs::copy(kReleased + "/0.1.0/sqlite", state, fs::copy_options::recursive);
  fs::permissions(state, fs::perms::owner_all);
  auto stores = Open("sqlite:" + state);
  ASSERT_TRUE(stores) << stores.error().message;
  EXPECT_FALSE(stores->recovery);
  const auto records = stores->specs->List("anonymous", "", 10);
  ASSERT_TRUE(records);
  ASSERT_EQ(records->size(), 2u);
  for (const SessionRecord& record : *records) ExpectAsReleased(*stores, record);
  const Usage usage = *stores->specs->UsageOf("anonymous");
  EXPECT_EQ(usage.sessions, 2u);
  EXPECT_EQ(usage.meshes, 2u);
  EXPECT_EQ(usage.bytes, 2 * 912u) << "of the records";
  ExpectToGoOn(*stores, records->front());
  stores->specs.reset();
  stores = Open("sqlite:" + state);
  ASSERT_TRUE(stores);
  EXPECT_EQ(stores->specs->Count(), 1u);
  EXPECT_EQ(stores->specs->UsageOf("anonymous")->bytes, 912u);
}

TEST(UpgradeTest, TheRedisOf0_1_0) {
  const testing::TempDir dir;
  testing::RedisServer redis;
  const std::string record = testing::Slurp(kReleased + "/0.1.0/redis.json");
  const std::string id = "239ebbebfecf7367f93f6379a7395831", place = "9:anonymous:" + id;
  const std::string blob = "3b6b5b32bdb8010b52a608de9b1af5bfad5b98968a1e1b10e6d7a537633a4569";
  for (const RedisCommand& command : std::vector<RedisCommand>{
           {"HSET", "arap:session:" + place, "revision", "3", "token", "655cabf5e34d7fdfff790bfa-3",
            "record", record, "expires", "1795998201832", "blobs", blob + " "},
           {"ZADD", "arap:ids:anonymous", "0", id},
           {"HSET", "arap:counts:anonymous", id, "1 1"},
           {"ZADD", "arap:owners", "0", "anonymous"},
           {"ZADD", "arap:expiry", "1795998201832", place}}) {
    testing::RawRedis(redis.Url(), command);
  }
  fs::copy(kReleased + "/0.1.0/sqlite/blobs", dir / "blobs", fs::copy_options::recursive);
  fs::permissions(dir / "blobs", fs::perms::owner_all);
  auto stores = Open(redis.Url(), dir / "blobs");
  ASSERT_TRUE(stores) << stores.error().message;
  const auto loaded = stores->specs->Load({"anonymous", id});
  ASSERT_TRUE(loaded && *loaded);
  ExpectAsReleased(*stores, **loaded);
  EXPECT_EQ(*stores->specs->ReferencedBlobs(), (std::set<std::string>{blob}));
  EXPECT_EQ(stores->specs->UsageOf("anonymous")->meshes, 1u);
  ExpectToGoOn(*stores, **loaded);
}

}  // namespace
}  // namespace arap::store
