#include "server/store/open_store.h"

#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "server/store/blobs/file_blobs.h"
#include "server/store/blobs/files.h"
#include "server/store/memory_store.h"
#include "server/store/redis/redis_store.h"
#include "server/store/redis/redis_url.h"
#include "server/store/sqlite/sqlite_store.h"
#include "server/store/store_fault.h"

namespace arap::store {
namespace {

constexpr std::string_view kSqlite = "sqlite:";
constexpr std::string_view kRedis = "redis:";

Fault Malformed(std::string message, std::string field) {
  return Fault(FaultKind::kInvalidOption, std::move(message)).Field(std::move(field));
}

std::string WithoutSlash(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

Status AddBlobs(const std::string& directory, Stores& stores) {
  auto blobs = FileBlobStore::Open(directory);
  if (!blobs) return Fail(blobs.error());
  stores.blobs = *std::move(blobs);
  return {};
}

Result<Stores> OpenSqlite(const StoreOptions& options) {
  const std::string directory = WithoutSlash(options.store.substr(kSqlite.size()));
  if (directory.empty()) {
    return Fail(Malformed("sqlite: wants the directory of the store: sqlite:DIR.", "store"));
  }
  if (const int error = MakeDirectory(directory); error != 0) {
    Fault fault = UnavailableErrno(error);
    fault.message = fmt::format("{}: {}", directory, fault.message);
    return Fail(fault.Detail("directory", directory));
  }
  auto specs = SqliteSpecStore::Open(directory, options.on_recovery);
  if (!specs) return Fail(specs.error());
  Stores stores;
  stores.recovery = (*specs)->recovery();
  stores.specs = *std::move(specs);
  const std::string blobs =
      options.blob_dir.empty() ? directory + "/blobs" : WithoutSlash(options.blob_dir);
  if (auto added = AddBlobs(blobs, stores); !added) return Fail(added.error());
  return stores;
}

Result<Stores> OpenRedis(const StoreOptions& options) {
  auto url = ParseRedisUrl(options.store);
  if (!url) return Fail(url.error());
  if (options.blob_dir.empty()) {
    return Fail(Malformed("With redis a blob directory that all replicas share has to be named.",
                          "blob_dir"));
  }
  RedisOptions redis;
  redis.url = *std::move(url);
  Stores stores;
  stores.specs = std::make_unique<RedisSpecStore>(std::move(redis));
  if (auto added = AddBlobs(WithoutSlash(options.blob_dir), stores); !added) {
    return Fail(added.error());
  }
  return stores;
}

}  // namespace

Result<Stores> OpenStores(const StoreOptions& options) {
  if (options.store == "memory") {
    Stores stores;
    stores.specs = std::make_unique<MemorySpecStore>();
    stores.blobs = std::make_unique<MemoryBlobStore>();
    return stores;
  }
  if (options.store.starts_with(kSqlite)) return OpenSqlite(options);
  if (options.store.starts_with(kRedis)) return OpenRedis(options);
  return Fail(Malformed(fmt::format("The store {} is none of memory, sqlite:DIR and "
                                    "redis://[:PASSWORD@]HOST[:PORT][/DB].",
                                    StoreForLog(options)),
                        "store"));
}

std::string StoreForLog(const StoreOptions& options) { return WithoutPassword(options.store); }

}  // namespace arap::store
