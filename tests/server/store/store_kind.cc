#include "tests/server/store/store_kind.h"

#include <chrono>
#include <stdexcept>
#include <utility>

namespace arap::testing {

std::ostream& operator<<(std::ostream& out, StoreKind kind) {
  constexpr const char* kNames[] = {"memory", "sqlite", "redis"};
  return out << kNames[static_cast<int>(kind)];
}

StoreUnderTest::StoreUnderTest(StoreKind kind) {
  store::StoreOptions options;
  if (kind == StoreKind::kSqlite) options.store = "sqlite:" + (dir_ / "state");
  if (kind == StoreKind::kRedis) {
    redis_ = std::make_unique<RedisServer>();
    options.store = redis_->Url();
    options.blob_dir = dir_ / "blobs";
  }
  auto stores = store::OpenStores(options);
  if (!stores) throw std::runtime_error(stores.error().message);
  stores_ = *std::move(stores);
}

store::RedisReply RawRedis(const std::string& url, const store::RedisCommand& command) {
  auto connection =
      store::RedisConnection::Open(*store::ParseRedisUrl(url), std::chrono::seconds(5));
  if (!connection) throw std::runtime_error(connection.error().message);
  auto replies = (*connection)->Run({command});
  if (!replies) throw std::runtime_error(replies.error().message);
  return std::move(replies->front());
}

}  // namespace arap::testing
