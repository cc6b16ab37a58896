// S3BlobStore: blobs in an S3-compatible object store, with a cache of this server.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "core/base/mutex.h"
#include "server/runtime/clock.h"
#include "server/store/blobs/blob_cache.h"
#include "server/store/blobs/s3_client.h"
#include "server/store/store.h"

namespace arap::store {

//   PREFIX blobs/abcd…   a blob
//   PREFIX aside/abcd…   blobs that no record named: Get brings them back, a later sweep removes them
//   PREFIX store-id      the id of the store that these are the blobs of
//
// Several servers may share a PREFIX; each has a cache of its own. An object is there with all its
// bytes or not at all, and for everybody at once. What Get returns has the digest it is named by,
// from the cache too. Ages are measured by the clock of the object store alone.
//
// There is no lock between servers. What is set aside while another server puts it again is
// aside and not lost: Get finds it there, and the next sweep brings back whatever a record names.
class S3BlobStore final : public BlobStore {
 public:
  // Listing costs a request for each thousand blobs: a sweep that comes sooner after the last one
  // than `sweep_every` does nothing and answers what that one has left. `cache` may be null.
  S3BlobStore(S3Options options, std::unique_ptr<BlobCache> cache,
              std::chrono::seconds sweep_every = std::chrono::minutes(10));

  Status Put(const std::string& hash, std::string_view bytes) override;
  Result<std::string> Get(const std::string& hash) override;
  Result<SweepReport> Sweep(const std::set<std::string>& referenced,
                            const SweepRules& rules) override;
  // A prefix without an id becomes this store's.
  Status Claim(const std::string& store_id) override;

 private:
  Status Move(const std::string& from, const std::string& to);
  // Nothing of the cache.
  Result<std::string> Fetch(const std::string& hash);
  Result<SweepReport> SweepNow(const std::set<std::string>& referenced, const SweepRules& rules);

  S3Client client_;
  const std::string where_;  // for people
  const std::unique_ptr<BlobCache> cache_;
  const std::chrono::seconds sweep_every_;
  const runtime::SystemClock clock_;
  Mutex mutex_;
  std::optional<runtime::Clock::Steady> swept_ ABSL_GUARDED_BY(mutex_);
  SweepReport last_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::store
