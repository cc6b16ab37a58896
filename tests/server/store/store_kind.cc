#include "tests/server/store/store_kind.h"

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

}  // namespace arap::testing
