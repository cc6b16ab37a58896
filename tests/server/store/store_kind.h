// StoreKind: the stores that the contract is tested on.
#pragma once

#include <memory>
#include <ostream>

#include "server/store/open_store.h"
#include "tests/server/store/redis_server.h"
#include "tests/server/store/temp_dir.h"

namespace arap::testing {

enum class StoreKind { kMemory, kSqlite, kRedis };
std::ostream& operator<<(std::ostream& out, StoreKind kind);

// A store with all that it needs to run.
class StoreUnderTest {
 public:
  explicit StoreUnderTest(StoreKind kind);

  store::SpecStore& specs() { return *stores_.specs; }
  store::BlobStore& blobs() { return *stores_.blobs; }

 private:
  TempDir dir_;
  std::unique_ptr<RedisServer> redis_;
  store::Stores stores_;
};

}  // namespace arap::testing
