// Shelf: the last few things of one kind, by name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace arap {

// Things are immutable and outlive their place here with whoever has them. Not thread-safe.
template <class T>
class Shelf {
 public:
  // At most `capacity`; the least recently used goes first. 0 keeps nothing.
  explicit Shelf(std::size_t capacity) : capacity_(capacity) {}

  // Null when it is not there.
  std::shared_ptr<const T> Find(const std::string& key) {
    const auto at = entries_.find(key);
    if (at == entries_.end()) return nullptr;
    at->second.used = ++clock_;
    return at->second.thing;
  }

  // The first under a key stays. An empty key is never kept.
  void Put(const std::string& key, std::shared_ptr<const T> thing) {
    if (capacity_ == 0 || key.empty() || entries_.contains(key)) return;
    if (entries_.size() >= capacity_) {
      auto oldest = entries_.begin();
      for (auto at = entries_.begin(); at != entries_.end(); ++at) {
        if (at->second.used < oldest->second.used) oldest = at;
      }
      entries_.erase(oldest);
    }
    entries_.try_emplace(key, Entry{std::move(thing), ++clock_});
  }

  // `size` tells what a thing holds beside itself.
  template <class Size>
  std::size_t Bytes(Size size) const {
    std::size_t bytes = 0;
    for (const auto& [key, entry] : entries_) {
      bytes += sizeof(std::pair<const std::string, Entry>) + key.capacity() + sizeof(T) +
               size(*entry.thing);
    }
    return bytes;
  }

 private:
  struct Entry {
    std::shared_ptr<const T> thing;
    std::uint64_t used = 0;
  };

  std::size_t capacity_;
  std::uint64_t clock_ = 0;
  std::map<std::string, Entry> entries_;
};

}  // namespace arap
