// FlattenCache: surfaces that callers named, prepared for flattening, so that asking again with
// other pins or weights does not begin from nothing.
#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "core/flatten/prepared_surface.h"

namespace arap::app {

// Thread-safe. Keeps at most `max_entries` surfaces of at most `max_bytes` together; the ones that
// were not asked for longest go first.
class FlattenCache {
 public:
  FlattenCache(std::size_t max_entries, std::size_t max_bytes)
      : max_entries_(max_entries), max_bytes_(max_bytes) {}

  // What is kept under `key`, or null: nothing, or a surface of other content.
  std::shared_ptr<const PreparedSurface> Find(const std::string& key,
                                              const std::string& content_hash);

  // Keeps `surface` instead of whatever `key` named. A surface grows when it is flattened: keeping
  // it again afterwards counts its bytes anew. One that is larger than `max_bytes` is not kept.
  void Keep(const std::string& key, const std::string& content_hash,
            std::shared_ptr<const PreparedSurface> surface);

  std::size_t entries() const;
  std::size_t bytes() const;

 private:
  struct Entry {
    std::string key;
    std::string content_hash;
    std::shared_ptr<const PreparedSurface> surface;
    std::size_t bytes = 0;
  };
  using Entries = std::list<Entry>;

  // Moves an entry to `gone`, which is freed without the lock: it may be large.
  void Remove(Entries::iterator entry, Entries& gone);

  const std::size_t max_entries_;
  const std::size_t max_bytes_;
  mutable std::mutex mutex_;
  Entries entries_;                                  // guarded by mutex_; the last used first
  std::map<std::string, Entries::iterator> by_key_;  // guarded by mutex_
  std::size_t bytes_ = 0;                            // guarded by mutex_
};

}  // namespace arap::app
