#include "server/app/flatten_cache.h"

#include <iterator>
#include <utility>

namespace arap::app {

std::shared_ptr<const PreparedSurface> FlattenCache::Find(const std::string& key,
                                                          const std::string& content_hash) {
  const std::lock_guard lock(mutex_);
  const auto found = by_key_.find(key);
  if (found == by_key_.end() || found->second->content_hash != content_hash) return nullptr;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->surface;
}

void FlattenCache::Keep(const std::string& key, const std::string& content_hash,
                        std::shared_ptr<const PreparedSurface> surface) {
  Entries gone;
  const std::size_t bytes = surface->bytes();
  const std::lock_guard lock(mutex_);
  if (const auto found = by_key_.find(key); found != by_key_.end()) Remove(found->second, gone);
  if (max_entries_ == 0 || bytes > max_bytes_) return;
  while (entries_.size() >= max_entries_ || bytes_ > max_bytes_ - bytes) {
    Remove(std::prev(entries_.end()), gone);
  }
  entries_.push_front({key, content_hash, std::move(surface), bytes});
  by_key_.emplace(key, entries_.begin());
  bytes_ += bytes;
}

void FlattenCache::Remove(Entries::iterator entry, Entries& gone) {
  bytes_ -= entry->bytes;
  by_key_.erase(entry->key);
  gone.splice(gone.end(), entries_, entry);
}

std::size_t FlattenCache::entries() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

std::size_t FlattenCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace arap::app
