// Who may speak to Redis, and to whom this server speaks: users, TLS, certificates.
#include <chrono>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "server/store/redis/redis_store.h"
#include "tests/server/store/records.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/store_kind.h"
#include "tests/server/store/temp_dir.h"

namespace arap::store {
namespace {

using testing::PlainRecord;

// What is wrong with a store of this URL; empty when nothing is.
std::string Complaint(const std::string& url, const std::optional<RedisTls>& tls = std::nullopt) {
  RedisOptions options;
  options.url = *ParseRedisUrl(url);
  if (tls) options.url.access.tls = tls;
  RedisSpecStore specs(options);
  const auto probe = specs.Probe();
  if (!probe) {
    EXPECT_EQ(probe.error().kind, FaultKind::kStoreUnavailable);
    EXPECT_EQ(probe.error().message.find("w0rd"), std::string::npos) << probe.error().message;
  }
  return probe ? "" : probe.error().message;
}

TEST(RedisAccessTest, UsersHaveNamesPasswordsAndKeys) {
  testing::RedisServer redis(testing::RedisSetup{
      {}, {"--user", "default", "off", "--user", "arapd", "on", ">w0rd", "~arap:*", "+@all"}, {}});
  const std::string place = "127.0.0.1:" + std::to_string(redis.port());
  EXPECT_EQ(Complaint("redis://arapd:w0rd@" + place), "");
  for (const char* wrong : {"arapd:w0rd2@", "arapd@", "other:w0rd@"}) {
    EXPECT_NE(Complaint(std::string("redis://") + wrong + place).find("user and password"),
              std::string::npos)
        << wrong;
  }
  EXPECT_NE(Complaint("redis://:w0rd@" + place).find("password"), std::string::npos);
  EXPECT_NE(Complaint("redis://" + place).find("NOAUTH"), std::string::npos);
  RedisOptions foreign;
  foreign.url = *ParseRedisUrl("redis://arapd:w0rd@" + place);
  foreign.prefix = "others:";
  const auto put = RedisSpecStore(foreign).Put(PlainRecord("ann", "s"));
  ASSERT_FALSE(put) << "keys that the user may not touch";
  EXPECT_NE(put.error().message.find("NOPERM"), std::string::npos) << put.error().message;
}

TEST(RedisAccessTest, TlsIsForWhoCanBeTrusted) {
  const testing::TempDir dir, other;
  testing::TlsRedis redis(dir.path(), {"--bind", "127.0.0.1", "127.0.0.2"});
  const testing::TlsRedis stranger(other.path());
  const std::string port = ":" + std::to_string(redis.tls_port());
  const RedisTls good{dir / "ca.pem", dir / "client.pem", dir / "client.key"};
  EXPECT_EQ(Complaint("rediss://127.0.0.1" + port, good), "");
  EXPECT_EQ(Complaint("rediss://localhost" + port, good), "");
  EXPECT_NE(Complaint("rediss://127.0.0.2" + port, good).find("IP address mismatch"),
            std::string::npos)
      << "it is not in the certificate";
  RedisTls tls = good;
  tls.ca = other / "ca.pem";
  EXPECT_NE(Complaint("rediss://localhost" + port, tls).find("cannot be trusted"),
            std::string::npos);
  tls.ca.clear();
  EXPECT_NE(Complaint("rediss://localhost" + port, tls).find("cannot be trusted"),
            std::string::npos)
      << "the authorities of this machine know nothing of it";
  EXPECT_NE(Complaint("rediss://localhost" + port, RedisTls{dir / "ca.pem", "", ""}), "")
      << "Redis wants a certificate";
  tls = {dir / "ca.pem", other / "client.pem", other / "client.key"};
  EXPECT_NE(Complaint("rediss://localhost" + port, tls), "") << "a certificate of somebody else";
  EXPECT_NE(Complaint("redis://localhost" + port), "") << "without TLS";
  EXPECT_NE(Complaint("rediss://localhost:" + std::to_string(redis.server()->port()), good), "")
      << "a port without TLS";
}

TEST(RedisAccessTest, LargeRecordsGoOverTlsAndNewCertificatesNeedNoRestart) {
  const testing::TempDir dir;
  testing::TlsRedis redis(dir.path());
  RedisOptions options;
  options.url = *ParseRedisUrl("rediss://localhost:" + std::to_string(redis.tls_port()));
  options.url.access.tls = RedisTls{dir / "ca.pem", dir / "client.pem", dir / "client.key"};
  options.timeout = std::chrono::seconds(20);
  RedisSpecStore specs(options);
  SessionRecord record = PlainRecord("ann", "s");
  for (int i = 0; i < 300; ++i) {
    record.labels["label-" + std::to_string(i)] = std::string(1'000, 'x');
  }
  ASSERT_EQ(specs.Put(record), true);
  EXPECT_EQ(testing::Difference(**specs.Load(record.key), record), "");
  const std::string key = testing::Slurp(dir / "client.key");
  testing::Spill(dir / "client.key", "being written");
  redis.server()->Kill();
  redis.server()->Restart();
  const auto half = specs.Probe();
  ASSERT_FALSE(half);
  EXPECT_NE(half.error().message.find("certificate files"), std::string::npos);
  EXPECT_EQ(half.error().message.find(dir.path()), std::string::npos) << "no path for clients";
  testing::Spill(dir / "client.key", key);
  EXPECT_TRUE(specs.Probe());
  EXPECT_EQ(testing::Difference(**specs.Load(record.key), record), "");
}

}  // namespace
}  // namespace arap::store
