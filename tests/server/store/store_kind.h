// StoreKind: the stores that the contract is tested on.
#pragma once

#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "server/runtime/clock.h"
#include "server/store/open_store.h"
#include "server/store/redis/redis_store.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/temp_dir.h"

namespace arap::testing {

// With TLS also by the name of a user.
enum class StoreKind { kMemory, kSqlite, kRedis, kRedisTls };
std::ostream& operator<<(std::ostream& out, StoreKind kind);

// A store with all that it needs to run.
class StoreUnderTest {
 public:
  explicit StoreUnderTest(StoreKind kind);

  store::SpecStore& specs() { return *stores_.specs; }
  store::BlobStore& blobs() { return *stores_.blobs; }

 private:
  void StartRedis(StoreKind kind, store::StoreOptions& options);

  TempDir dir_;
  std::unique_ptr<RedisServer> redis_;
  store::Stores stores_;
};

// A Redis that speaks TLS too, with certificates of its own in a folder: "ca.pem", which has made them
// all, "server.pem" for localhost and 127.0.0.1, "client.pem" and "client.key".
class TlsRedis {
 public:
  // `words` are more of its command line.
  explicit TlsRedis(const std::string& folder, const std::vector<std::string>& words = {});

  int tls_port() const { return tls_port_; }
  std::unique_ptr<RedisServer>& server() { return server_; }

 private:
  int tls_port_ = 0;
  std::unique_ptr<RedisServer> server_;
};

// A command past the store; a failure of the test when Redis does not answer it.
store::RedisReply RawRedis(const std::string& url, const store::RedisCommand& command);

// Redis whose own clock is the one of the test.
class RedisWithFakeTime final : public store::RedisSpecStore {
 public:
  RedisWithFakeTime(const RedisServer& redis, const runtime::Clock& clock)
      : RedisSpecStore(store::RedisOptions{*store::ParseRedisUrl(redis.Url())}), clock_(clock) {}
  Result<std::optional<runtime::Clock::Wall>> Time() override { return clock_.WallNow(); }

 private:
  const runtime::Clock& clock_;
};

}  // namespace arap::testing
