// OpenStores: what it takes and what it says about the rest.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/store/open_store.h"
#include "server/store/redis/redis.h"
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
  for (const char* store : {"", "sqlite", "sqlite:", "Memory", "mongo://x", "redis:", "redis://",
                            "redis://:6379", "redis://h:0", "redis://h:65536", "redis://h:x",
                            "redis://h/x", "redis://user@h", "redis://:%4@h", "redis://[::1"}) {
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
  EXPECT_EQ(full->host, "::1");
  EXPECT_EQ(full->port, 7000);
  EXPECT_EQ(full->password, "p@ss:w");
  EXPECT_EQ(full->database, 3);
  const auto plain = ParseRedisUrl("redis://example.org/");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->host, "example.org");
  EXPECT_EQ(plain->port, 6379);
}

TEST(OpenStoreTest, NoFaultNamesAPassword) {
  for (const char* store : {"redis://:secret@h:x", "redis:/:secret@h", "http://:secret@h"}) {
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
