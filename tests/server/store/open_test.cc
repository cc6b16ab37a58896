// OpenStores: what it takes and what it says about the rest.
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/store/open_store.h"
#include "server/store/redis/redis.h"
#include "server/store/redis/redis_url.h"
#include "tests/server/store/records.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/store_kind.h"
#include "tests/server/store/temp_dir.h"

namespace arap::store {
namespace {

Result<Stores> Open(const std::string& store, const std::string& blob_dir = "") {
  StoreOptions options;
  options.store = store;
  options.blob_dir = blob_dir;
  return OpenStores(options);
}

TEST(OpenStoreTest, WhatIsMalformedIsNamed) {
  for (const char* store : {"",
                            "sqlite",
                            "sqlite:",
                            "Memory",
                            "mongo://x",
                            "redis:",
                            "redis://",
                            "redis://:6379",
                            "redis://h:0",
                            "redis://h:65536",
                            "redis://h:x",
                            "redis://h/x",
                            "redis://@h",
                            "redis://:%4@h",
                            "redis://u%4@h",
                            "redis://[::1",
                            "redis://a,b",
                            "redis://h/0/1",
                            "redis+tls://h",
                            "redis+sentinel://h",
                            "redis+sentinel://h/",
                            "redis+sentinel://h,/m",
                            "redis+sentinel://h/m/x",
                            "redis+sentinel:///m",
                            "redis+cluster://",
                            "redis+cluster://h/1",
                            "redis+cluster://h,",
                            "rediss:h"}) {
    const auto stores = Open(store, "/nonexistent");
    ASSERT_FALSE(stores) << store;
    EXPECT_EQ(stores.error().kind, FaultKind::kInvalidOption) << store;
    EXPECT_EQ(stores.error().field, "store") << store;
  }
  EXPECT_EQ(Open("redis://h").error().field, "blob_dir");
}

TEST(OpenStoreTest, UrlsOfRedis) {
  const auto full = ParseRedisUrl("redis://:p%40ss:w@[::1]:7000/3");
  ASSERT_TRUE(full);
  EXPECT_EQ(full->places, (std::vector<RedisPlace>{{"::1", 7000}}));
  EXPECT_EQ(full->access.user, "");
  EXPECT_EQ(full->access.password, "p@ss:w");
  EXPECT_EQ(full->access.database, 3);
  EXPECT_FALSE(full->access.tls);
  const auto plain = ParseRedisUrl("redis://example.org/");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->kind, RedisUrl::Kind::kServer);
  EXPECT_EQ(plain->places, (std::vector<RedisPlace>{{"example.org", 6379}}));
  const auto sentinels = ParseRedisUrl("rediss+sentinel://us%65r:w@a,[::2]:7,c:8/main/5");
  ASSERT_TRUE(sentinels);
  EXPECT_EQ(sentinels->kind, RedisUrl::Kind::kSentinels);
  EXPECT_EQ(sentinels->places, (std::vector<RedisPlace>{{"a", 26379}, {"::2", 7}, {"c", 8}}));
  EXPECT_EQ(sentinels->master, "main");
  EXPECT_EQ(sentinels->access.user, "user");
  EXPECT_EQ(sentinels->access.password, "w");
  EXPECT_EQ(sentinels->access.database, 5);
  EXPECT_TRUE(sentinels->access.tls);
  const auto cluster = ParseRedisUrl("redis+cluster://user@a:1,b/0");
  ASSERT_TRUE(cluster);
  EXPECT_EQ(cluster->kind, RedisUrl::Kind::kCluster);
  EXPECT_EQ(cluster->places, (std::vector<RedisPlace>{{"a", 1}, {"b", 6379}}));
  EXPECT_EQ(cluster->access.user, "user");
}

TEST(OpenStoreTest, WhatIsToldOfRedisHasToFit) {
  const testing::TempDir dir;
  testing::Spill(dir / "junk", "no certificate");
  const struct {
    std::string store;
    RedisFlags flags = {};
    std::string field, says;
  } kCases[] = {
      {"redis://h", {.ca = dir / "junk"}, "redis_ca", "rediss"},
      {"memory", {.certificate = "a", .key = "b"}, "redis_cert", "rediss"},
      {"redis://h", {.key = "b"}, "redis_key", "rediss"},
      {"rediss://h", {.key = "b"}, "redis_key", "go together"},
      {"rediss://h", {.certificate = "b"}, "redis_cert", "go together"},
      {"rediss://h", {.ca = dir / "junk"}, "redis_ca", "no certificate"},
      {"rediss://h", {.ca = dir / "none"}, "redis_ca", "none"},
      {"rediss://h", {.certificate = dir / "junk", .key = dir / "junk"}, "redis_cert", "junk"},
      {"redis://h", {.sentinel_password = "s3cret"}, "redis_sentinel_password_file", "sentinel"},
      {"sqlite:x", {.replicas = 1}, "redis_replicas", "redis://"},
  };
  for (const auto& [store, flags, field, says] : kCases) {
    StoreOptions options;
    options.store = store;
    options.blob_dir = dir / "blobs";
    options.redis = flags;
    const Status checked = CheckStore(options);
    ASSERT_FALSE(checked) << store << " " << field;
    EXPECT_EQ(checked.error().kind, FaultKind::kInvalidOption);
    EXPECT_EQ(checked.error().field, field);
    EXPECT_NE(checked.error().message.find(says), std::string::npos) << checked.error().message;
    EXPECT_EQ(checked.error().message.find("s3cret"), std::string::npos);
  }
}

TEST(OpenStoreTest, NoFaultNamesAPassword) {
  for (const char* store : {"redis://:secret@h:x", "redis:/:secret@h", "http://:secret@h",
                            "rediss+sentinel://user:secret@a,b", "redis+cluster://u:secret@a/9",
                            "redis://secret@h:x"}) {
    StoreOptions options;
    options.store = store;
    EXPECT_EQ(Open(store, "/nonexistent").error().message.find("secret"), std::string::npos);
    EXPECT_EQ(StoreForLog(options).find("secret"), std::string::npos);
  }
}

TEST(OpenStoreTest, DirectoriesArePrivate) {
  const testing::TempDir dir;
  ASSERT_TRUE(Open("sqlite:" + (dir / "state/")));
  struct stat info {};
  ASSERT_EQ(stat((dir / "state").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777u, 0700u);
  ASSERT_EQ(stat((dir / "state/blobs").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777u, 0700u);
  ASSERT_EQ(stat((dir / "state/sessions.db").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777u, 0600u);
}

TEST(OpenStoreTest, WhatEarlierVersionsLeftOpenIsClosed) {
  const testing::TempDir dir;
  const std::string database = dir / "state/sessions.db";
  ASSERT_TRUE(Open("sqlite:" + (dir / "state")));
  ASSERT_EQ(chmod(database.c_str(), 0644), 0);
  auto stores = Open("sqlite:" + (dir / "state"));
  ASSERT_TRUE(stores);
  ASSERT_EQ(stores->specs->Put(testing::PlainRecord("ann", "s")), true);
  for (const char* part : {"", "-wal"}) {
    struct stat info {};
    ASSERT_EQ(stat((database + part).c_str(), &info), 0) << part;
    EXPECT_EQ(info.st_mode & 0777u, 0600u) << part;
  }
}

TEST(OpenStoreTest, AFolderThatEverybodyMayWriteIntoIsRefused) {
  const testing::TempDir dir;
  for (const char* open : {"state", "state/blobs"}) {
    ASSERT_TRUE(Open("sqlite:" + (dir / "state")));
    ASSERT_EQ(chmod((dir / open).c_str(), 0777), 0);
    const auto stores = Open("sqlite:" + (dir / "state"));
    ASSERT_FALSE(stores) << open;
    EXPECT_NE(stores.error().message.find("chmod o-w"), std::string::npos) << open;
    ASSERT_EQ(chmod((dir / open).c_str(), 0700), 0);
  }
}

// With the blobs of another store its own would be swept away, and the other's too.
TEST(OpenStoreTest, TheBlobsOfAnotherStoreAreRefused) {
  const testing::TempDir dir;
  const std::string blobs = dir / "blobs";
  ASSERT_TRUE(Open("sqlite:" + (dir / "one"), blobs));
  ASSERT_TRUE(Open("sqlite:" + (dir / "one"), blobs));
  testing::RedisServer redis;
  for (const std::string& store : {"sqlite:" + (dir / "two"), redis.Url(), redis.Url() + "/1"}) {
    const auto other = Open(store, blobs);
    ASSERT_FALSE(other) << store;
    EXPECT_EQ(other.error().kind, FaultKind::kInvalidOption);
    EXPECT_NE(other.error().message.find("belong to another store"), std::string::npos);
  }
  ASSERT_TRUE(Open(redis.Url(), dir / "shared"));
  ASSERT_TRUE(Open(redis.Url(), dir / "shared")) << "another replica";
  EXPECT_FALSE(Open(redis.Url() + "/1", dir / "shared"));
  testing::RawRedis(redis.Url(), {"FLUSHALL"});
  EXPECT_FALSE(Open(redis.Url(), dir / "shared")) << "an emptied one";
}

TEST(OpenStoreTest, ARedisThatLosesThingsIsRefusedUnlessAllowed) {
  using Commands = std::vector<RedisCommand>;
  for (const auto& [commands, word] :
       {std::pair{Commands{{"CONFIG", "SET", "maxmemory", "100mb"},
                           {"CONFIG", "SET", "maxmemory-policy", "allkeys-lru"}},
                  "allkeys-lru"},
        std::pair{Commands{{"CONFIG", "SET", "appendonly", "no"}}, "keeps nothing"}}) {
    const testing::TempDir dir;
    testing::RedisServer redis;
    for (const RedisCommand& command : commands) testing::RawRedis(redis.Url(), command);
    const auto refused = Open(redis.Url(), dir / "blobs");
    ASSERT_FALSE(refused) << word;
    EXPECT_NE(refused.error().message.find(word), std::string::npos) << refused.error().message;
    EXPECT_NE(refused.error().message.find("--allow-lossy-store"), std::string::npos);
    StoreOptions options;
    options.store = redis.Url();
    options.blob_dir = dir / "blobs";
    options.allow_lossy = true;
    const auto allowed = OpenStores(options);
    ASSERT_TRUE(allowed) << allowed.error().message;
    EXPECT_EQ(allowed->specs->Facts()->weaknesses.size(), 1u) << "but told";
    EXPECT_TRUE(allowed->blobs->Claim(allowed->specs->Facts()->id));
    testing::RawRedis(redis.Url(), {"FLUSHALL"});
    EXPECT_TRUE(OpenStores(options)) << "it has lost everything, as it may";
  }
  // Snapshots are told, too, and no reason to refuse.
  const testing::TempDir dir;
  testing::RedisServer redis;
  testing::RawRedis(redis.Url(), {"CONFIG", "SET", "appendonly", "no"});
  testing::RawRedis(redis.Url(), {"CONFIG", "SET", "save", "3600 1"});
  const auto stores = Open(redis.Url(), dir / "blobs");
  ASSERT_TRUE(stores);
  EXPECT_STREQ(stores->specs->Facts()->weaknesses.at(0).reason, "flushes_rarely");
}

TEST(OpenStoreTest, OneServerPerDirectory) {
  const testing::TempDir dir;
  const std::string state = dir / "state";
  auto first = Open("sqlite:" + state);
  ASSERT_TRUE(first);
  const auto second = Open("sqlite:" + state);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, FaultKind::kStoreUnavailable);
  EXPECT_NE(second.error().message.find(state), std::string::npos);
  EXPECT_NE(second.error().message.find("another server"), std::string::npos);
  first->specs.reset();
  EXPECT_TRUE(Open("sqlite:" + state));
}

TEST(OpenStoreTest, ADirectoryThatCannotBeIsNamed) {
  const testing::TempDir dir;
  testing::Spill(dir / "file", "");
  for (const std::string& path : {dir / "file", dir / "no/such", dir / "file/below"}) {
    const auto stores = Open("sqlite:" + path);
    ASSERT_FALSE(stores);
    EXPECT_EQ(stores.error().kind, FaultKind::kStoreUnavailable);
    EXPECT_NE(stores.error().message.find(path), std::string::npos) << stores.error().message;
  }
}

}  // namespace
}  // namespace arap::store
