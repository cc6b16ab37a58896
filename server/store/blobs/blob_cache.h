// BlobCache: a folder of this server with blobs that come from far away.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "core/base/mutex.h"

namespace arap::store {

// Thread-safe; one process per folder. It is a convenience: what cannot be written is not kept, what
// is damaged is not there, and nothing is flushed. With more than `most` bytes in it the blobs that
// were used least recently go.
class BlobCache {
 public:
  // Makes the folder, in a parent that is there, and takes over what an earlier server has left in
  // it. kStoreUnavailable, naming the folder, when that cannot be or another process has it.
  static Result<std::unique_ptr<BlobCache>> Open(const std::string& folder, std::size_t most);
  ~BlobCache();
  BlobCache(const BlobCache&) = delete;
  BlobCache& operator=(const BlobCache&) = delete;

  void Put(const std::string& hash, std::string_view bytes);
  // Only bytes whose SHA-256 is `hash`. Nothing when it is not there.
  std::optional<std::string> Get(const std::string& hash);

  std::size_t bytes() const;

 private:
  struct Lock;

  BlobCache(std::string folder, std::size_t most);
  // Removes what was used least recently until there is room for `more` bytes.
  void MakeRoom(std::size_t more) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::string PathOf(const std::string& hash) const { return folder_ + "/" + hash; }

  const std::string folder_;
  const std::size_t most_;
  std::unique_ptr<Lock> lock_;
  mutable Mutex mutex_;
  std::size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace arap::store
