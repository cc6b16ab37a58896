#include "tests/server/store/store_kind.h"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "tests/system/wire/authority.h"

namespace arap::testing {

std::ostream& operator<<(std::ostream& out, StoreKind kind) {
  constexpr const char* kNames[] = {"memory", "sqlite", "redis", "redis_tls"};
  return out << kNames[static_cast<int>(kind)];
}

TlsRedis::TlsRedis(const std::string& folder, const std::vector<std::string>& words) {
  const wire::Authority authority("authority of redis");
  const auto server = authority.Issue("redis"), client = authority.Issue("arapd");
  Spill(folder + "/ca.pem", authority.certificate());
  Spill(folder + "/server.pem", server.certificate);
  Spill(folder + "/server.key", server.key);
  Spill(folder + "/client.pem", client.certificate);
  Spill(folder + "/client.key", client.key);
  tls_port_ = FreePort();
  RedisSetup setup;
  setup.words = {"--tls-port",           std::to_string(tls_port_), "--tls-cert-file",
                 folder + "/server.pem", "--tls-key-file",          folder + "/server.key",
                 "--tls-ca-cert-file",   folder + "/ca.pem"};
  setup.words.insert(setup.words.end(), words.begin(), words.end());
  server_ = std::make_unique<RedisServer>(std::move(setup));
}

void StoreUnderTest::StartRedis(StoreKind kind, store::StoreOptions& options) {
  options.blob_dir = dir_ / "blobs";
  if (kind == StoreKind::kRedis) {
    redis_ = std::make_unique<RedisServer>();
    options.store = redis_->Url();
  } else {
    TlsRedis tls(dir_.path(),
                 {"--user", "arapd", "on", ">w0rd", "~arap:*", "+@read", "+@write", "+@scripting",
                  "+@connection", "+time", "+wait", "+info", "+config|get"});
    options.store = "rediss://arapd:w0rd@localhost:" + std::to_string(tls.tls_port());
    options.redis.ca = dir_ / "ca.pem";
    options.redis.certificate = dir_ / "client.pem";
    options.redis.key = dir_ / "client.key";
    redis_ = std::move(tls.server());
  }
}

StoreUnderTest::StoreUnderTest(StoreKind kind) {
  store::StoreOptions options;
  if (kind == StoreKind::kSqlite) options.store = "sqlite:" + (dir_ / "state");
  if (kind >= StoreKind::kRedis) StartRedis(kind, options);
  auto stores = store::OpenStores(options);
  if (!stores) throw std::runtime_error(stores.error().message);
  stores_ = *std::move(stores);
}

store::RedisReply RawRedis(const std::string& url, const store::RedisCommand& command) {
  const auto parsed = store::ParseRedisUrl(url);
  auto connection =
      store::RedisConnection::Open(parsed->places.front(), parsed->access, std::chrono::seconds(5));
  if (!connection) throw std::runtime_error(connection.error().message);
  auto replies = (*connection)->Run(std::vector<store::RedisCommand>{command});
  if (!replies) throw std::runtime_error(replies.error().message);
  return std::move(replies->front());
}

}  // namespace arap::testing
