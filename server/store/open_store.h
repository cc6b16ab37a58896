// Stores: opening what the configuration names, and measuring what it does.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "arap/base/result.h"
#include "server/runtime/metrics.h"
#include "server/store/store.h"

namespace arap::store {

// What is told of Redis beside its URL. All may be left out.
struct RedisFlags {
  std::string sentinel_password = {};
  std::string ca = {}, certificate = {}, key = {};  // files in PEM, for rediss://
  int replicas = 0;                                 // that have to confirm a change
};

// What is told of blobs in an object store beside its URL.
struct S3Flags {
  std::string endpoint = {};  // empty: that of Amazon in the region
  std::string region = "us-east-1";
  std::string credentials_file = {};
  std::string key_id = {}, secret = {}, session_token = {};  // without a file
  std::string ca = {};                                       // authorities in PEM
  std::size_t cache_bytes = std::size_t{4} << 30u;
};

struct StoreOptions {
  // memory          everything ends with the process
  // sqlite:DIR      records and blobs in a directory, for one server
  // redis://…       records in Redis, for many servers (redis/redis_url.h has all forms)
  std::string store = "memory";
  // Where blobs are. With sqlite DIR/blobs when empty; with redis a folder that all replicas share;
  // without meaning for memory. With a blob store the cache of this server, or empty for none.
  std::string blob_dir;
  // Empty, or s3://BUCKET[/PREFIX]: blobs in an S3-compatible object store.
  std::string blob_store;
  S3Flags s3;
  RedisFlags redis;
  // Starts also with a store that may lose what it has acknowledged: a Redis that evicts keys or
  // writes nothing to disk. Then blobs that are another store's, as they are when Redis has lost
  // everything, are no reason not to start either; they are not swept.
  bool allow_lossy = false;
  // Hears of databases that were repaired after opening; called within a call of the store.
  std::function<void(const Recovery&)> on_recovery;
};

struct Stores {
  std::unique_ptr<SpecStore> specs;
  std::unique_ptr<BlobStore> blobs;
  // The database was damaged: what became of it.
  std::optional<Recovery> recovery;
  bool allow_lossy = false;  // as in the options
};

// Whether the options are well-formed; looks at nothing but the files that they name.
// kInvalidOption with the field "store", "blob_dir", "blob_store", "redis_ca", "redis_cert",
// "redis_key", "redis_replicas", "redis_sentinel_password_file", "s3_endpoint", "s3_region" or
// "s3_credentials_file". No fault names a password.
Status CheckStore(const StoreOptions& options);

// Makes DIR and the blob directory, with mode 0700, in parents that are there. Redis need not be
// reachable yet. The faults of CheckStore; kStoreUnavailable, naming the directory, for one that
// cannot be used or is in use by another server, and for a store that may lose what it has
// acknowledged; kInvalidOption with the field "blob_dir" for blobs that are another store's.
Result<Stores> OpenStores(const StoreOptions& options);

// The same stores, with the time and the outcome of every call in the metrics, which outlive them.
// There the calls are named "load", "put", "blob_put", ….
Stores Measured(Stores stores, runtime::Metrics& metrics);

// The store as it may be logged: without its password.
std::string StoreForLog(const StoreOptions& options);

}  // namespace arap::store
