// FactorCache: factors of one prepared surface, kept for the next time it is flattened.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "core/base/result.h"
#include "core/flatten/grounded_system.h"

namespace arap {

// Thread-safe. Two callers that miss at once both factor; the first one's is kept.
class FactorCache {
 public:
  // At most `capacity` factors of each kind; the least recently used goes first. 0 keeps nothing.
  explicit FactorCache(std::size_t capacity) : capacity_(capacity) {}

  // The factor under `key`, from make() when it is not there. An empty key is never kept.
  template <class Scalar, class Make>
  Result<std::shared_ptr<const GroundedSystem<Scalar>>> Get(const std::string& key, Make make) {
    Shelf<Scalar>& shelf = ShelfOf(static_cast<Scalar*>(nullptr));
    if (auto found = Find(shelf, key)) return found;
    Result<GroundedSystem<Scalar>> made = make();
    if (!made) return Fail(std::move(made.error()));
    auto system = std::make_shared<const GroundedSystem<Scalar>>(*std::move(made));
    if (capacity_ > 0 && !key.empty()) Put(shelf, key, system);
    return system;
  }

  std::size_t bytes() const {
    const std::scoped_lock lock(mutex_);
    return Bytes(similarity_) + Bytes(rigid_);
  }

 private:
  template <class Scalar>
  struct Entry {
    std::shared_ptr<const GroundedSystem<Scalar>> system;
    std::uint64_t used = 0;
  };
  template <class Scalar>
  using Shelf = std::map<std::string, Entry<Scalar>>;

  Shelf<Complex>& ShelfOf(Complex*) { return similarity_; }
  Shelf<double>& ShelfOf(double*) { return rigid_; }

  template <class Scalar>
  std::shared_ptr<const GroundedSystem<Scalar>> Find(Shelf<Scalar>& shelf, const std::string& key) {
    const std::scoped_lock lock(mutex_);
    const auto at = shelf.find(key);
    if (at == shelf.end()) return nullptr;
    at->second.used = ++clock_;
    return at->second.system;
  }

  template <class Scalar>
  void Put(Shelf<Scalar>& shelf, const std::string& key,
           std::shared_ptr<const GroundedSystem<Scalar>> system) {
    const std::scoped_lock lock(mutex_);
    if (shelf.contains(key)) return;
    if (shelf.size() >= capacity_) {
      auto oldest = shelf.begin();
      for (auto at = shelf.begin(); at != shelf.end(); ++at) {
        if (at->second.used < oldest->second.used) oldest = at;
      }
      shelf.erase(oldest);
    }
    shelf.try_emplace(key, Entry<Scalar>{std::move(system), ++clock_});
  }

  template <class Scalar>
  static std::size_t Bytes(const Shelf<Scalar>& shelf) {
    std::size_t bytes = 0;
    for (const auto& [key, entry] : shelf) {
      bytes += sizeof(typename Shelf<Scalar>::value_type) + sizeof(*entry.system) + key.capacity() +
               entry.system->bytes();
    }
    return bytes;
  }

  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::uint64_t clock_ = 0;
  Shelf<Complex> similarity_;
  Shelf<double> rigid_;
};

}  // namespace arap
