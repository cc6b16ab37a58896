// Redis that goes and comes back, hangs, refuses, or holds nonsense.
#include <chrono>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>

#include "server/store/redis/redis_store.h"
#include "tests/server/store/lossy_proxy.h"
#include "tests/server/store/records.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/store_kind.h"
#include "tests/support/bounded.h"

namespace arap::store {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using testing::Next;
using testing::PlainRecord;

RedisOptions Options(const std::string& url) {
  RedisOptions options;
  options.url = *ParseRedisUrl(url);
  options.timeout = milliseconds(300);
  return options;
}

using testing::RawRedis;

TEST(RedisFaultTest, GoneIsSaidAtOnceAndBackWorksAtOnce) {
  testing::RedisServer redis;
  RedisSpecStore specs(Options(redis.Url()));
  SessionRecord record = PlainRecord("ann", "s");
  ASSERT_EQ(specs.Put(record), true);
  for (int round = 0; round < 3; ++round) {
    redis.Kill();
    const auto start = steady_clock::now();
    for (int i = 0; i < 20; ++i) {
      const auto put = specs.Put(Next(record));
      ASSERT_FALSE(put);
      EXPECT_EQ(put.error().kind, FaultKind::kStoreUnavailable);
    }
    EXPECT_FALSE(specs.Probe());
    EXPECT_LT(steady_clock::now() - start, std::chrono::seconds(5)) << "20 calls that fail";
    redis.Restart();
    EXPECT_EQ(**specs.Version(record.key), VersionOf(record));
    record = Next(record);
    EXPECT_EQ(specs.Put(record), true) << "scripts are sent again";
    EXPECT_EQ(testing::Difference(**specs.Load(record.key), record), "");
  }
}

TEST(RedisFaultTest, AHangEndsWithTheTimeoutForAllCallers) {
  testing::RedisServer redis;
  RedisSpecStore specs(Options(redis.Url()));
  ASSERT_TRUE(specs.Probe());
  redis.Freeze();
  const auto start = steady_clock::now();
  constexpr std::size_t kCallers = 8;
  std::vector<testing::BoundedThread> callers;
  callers.reserve(kCallers);
  for (std::size_t i = 0; i < kCallers; ++i) {
    callers.emplace_back("a caller of a store that hangs", [&] {
      for (int call = 0; call < 3; ++call) {
        const auto probe = specs.Probe();
        ASSERT_FALSE(probe);
        EXPECT_EQ(probe.error().kind, FaultKind::kStoreUnavailable);
      }
    });
  }
  callers.clear();
  // 24 calls one after the other would take 7 s and more.
  EXPECT_LT(steady_clock::now() - start, std::chrono::seconds(4));
  redis.Thaw();
  const auto deadline = steady_clock::now() + std::chrono::seconds(30);
  while (!specs.Probe() && steady_clock::now() < deadline) poll(nullptr, 0, 10);
  EXPECT_TRUE(specs.Probe());
}

TEST(RedisFaultTest, PasswordsOpenAndStaySecret) {
  testing::RedisServer redis("s3cret");
  RedisSpecStore right(Options(redis.Url()));
  EXPECT_EQ(right.Put(PlainRecord("ann", "s")), true);
  RedisOptions options = Options(redis.Url());
  for (const char* password : {"wr0ng-one", ""}) {
    options.url.access.password = password;
    RedisSpecStore wrong(options);
    const auto probe = wrong.Probe();
    ASSERT_FALSE(probe);
    EXPECT_EQ(probe.error().kind, FaultKind::kStoreUnavailable);
    EXPECT_EQ(probe.error().message.find("wr0ng"), std::string::npos);
  }
}

TEST(RedisFaultTest, ReplicasSeeEachOther) {
  testing::RedisServer redis;
  RedisSpecStore first(Options(redis.Url())), second(Options(redis.Url()));
  const SessionRecord record = PlainRecord("ann", "s");
  EXPECT_EQ(first.Put(record), true);
  EXPECT_EQ(second.Put(record), false);
  EXPECT_EQ(second.Put(Next(record)), true);
  EXPECT_EQ(first.Put(Next(record)), false) << "equal, but somebody else's";
  EXPECT_EQ((*first.Version(record.key))->revision, 2u);
  EXPECT_TRUE(first.shared());
}

TEST(RedisFaultTest, NonsenseIsLostAlone) {
  testing::RedisServer redis;
  RedisSpecStore specs(Options(redis.Url()));
  for (const char* id : {"a", "b", "c"}) ASSERT_EQ(specs.Put(PlainRecord("ann", id)), true);
  RawRedis(redis.Url(), {"HSET", "arap:session:3:ann:b", "record", "nonsense"});
  const auto lost = specs.Load({"ann", "b"});
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().kind, FaultKind::kDataLoss);
  EXPECT_EQ(lost.error().details.at(1).second, "b");
  EXPECT_EQ(specs.List("ann", "", 2)->size(), 2u) << "the page is filled with what follows";
  EXPECT_EQ(specs.Remove({"ann", "b"}), true);
  RawRedis(redis.Url(), {"SET", "arap:session:3:ann:c", "another type"});
  EXPECT_EQ(specs.Load({"ann", "c"}).error().kind, FaultKind::kStoreUnavailable);
  EXPECT_TRUE(specs.Load({"ann", "a"})->has_value());
}

TEST(RedisFaultTest, SessionsThatNobodyRemovesGoByThemselvesADayLater) {
  testing::RedisServer redis;
  RedisSpecStore specs(Options(redis.Url()));
  SessionRecord record = PlainRecord("ann", "s");
  ASSERT_EQ(specs.Put(record), true);
  const auto left = [&] {
    return milliseconds(RawRedis(redis.Url(), {"PTTL", "arap:session:3:ann:s"}).Int());
  };
  EXPECT_GT(left(), std::chrono::hours(24) + std::chrono::minutes(50));
  EXPECT_LT(left(), std::chrono::hours(25) + std::chrono::minutes(1));
  EXPECT_EQ(specs.Extend(record.key, record.incarnation, record.expires + std::chrono::hours(10)),
            true);
  EXPECT_GT(left(), std::chrono::hours(34));
  const auto before = record.created - std::chrono::hours(30);
  EXPECT_EQ(specs.Extend(record.key, record.incarnation, before), true);
  EXPECT_GT(left(), std::chrono::hours(23)) << "counted from now at the earliest";
  // Redis did it: what is left of it is found and named.
  RawRedis(redis.Url(), {"DEL", "arap:session:3:ann:s"});
  EXPECT_FALSE(specs.Load(record.key)->has_value());
  EXPECT_TRUE(specs.List("ann", "", 10)->empty());
  EXPECT_EQ(specs.RemoveExpired(testing::Now(), 10)->size(), 1u);
  EXPECT_EQ(specs.UsageOf("ann")->sessions, 0u);
  EXPECT_EQ(RawRedis(redis.Url(), {"DBSIZE"}).Int(), 0) << "nothing stays";
}

TEST(RedisFaultTest, AFullRedisRefusesByName) {
  testing::RedisServer redis;
  RedisSpecStore specs(Options(redis.Url()));
  ASSERT_EQ(specs.Put(PlainRecord("ann", "s")), true);
  RawRedis(redis.Url(), {"CONFIG", "SET", "maxmemory", "1"});
  const auto put = specs.Put(PlainRecord("ann", "t"));
  ASSERT_FALSE(put);
  EXPECT_EQ(put.error().kind, FaultKind::kStoreUnavailable);
  EXPECT_NE(put.error().message.find("OOM"), std::string::npos) << put.error().message;
  EXPECT_TRUE(specs.Load({"ann", "s"})->has_value());
  RawRedis(redis.Url(), {"CONFIG", "SET", "maxmemory", "0"});
  EXPECT_EQ(specs.Put(PlainRecord("ann", "t")), true);
}

// A connection that breaks after the work and before the answer: the call is done once more.
TEST(RedisFaultTest, WhatWasDoneBeforeTheConnectionBrokeCounts) {
  testing::RedisServer redis;
  testing::LossyProxy proxy(redis.port());
  RedisSpecStore specs(Options(proxy.Url()));
  SessionRecord record = PlainRecord("ann", "s");
  ASSERT_EQ(specs.Put(record), true);
  proxy.LoseNextAnswer();
  record = Next(record);
  EXPECT_EQ(specs.Put(record), true);
  EXPECT_EQ(**specs.Version(record.key), VersionOf(record));
  proxy.LoseNextAnswer();
  EXPECT_EQ(specs.Remove(record.key), true);
  EXPECT_EQ(specs.Remove(record.key), false);
  EXPECT_EQ(proxy.lost(), 2);
}

}  // namespace
}  // namespace arap::store
