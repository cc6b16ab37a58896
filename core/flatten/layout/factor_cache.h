// FactorCache: factors of one prepared surface, kept for the next time it is flattened, and the
// elimination orders that they were made with.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "arap/base/result.h"
#include "core/flatten/layout/grounded_system.h"
#include "core/flatten/sheet/shelf.h"

namespace arap {

// Thread-safe. Two callers that miss at once both make it; the first one's is kept.
class FactorCache {
 public:
  // At most `capacity` things of each kind; the least recently used goes first. 0 keeps nothing.
  explicit FactorCache(std::size_t capacity)
      : similarity_(capacity), rigid_(capacity), orders_(capacity) {}

  // The factor under `key`, from make() when it is not there. An empty key is never kept.
  template <class Scalar, class Make>
  Result<std::shared_ptr<const GroundedSystem<Scalar>>> Get(const std::string& key, Make make) {
    return From(ShelfOf(static_cast<Scalar*>(nullptr)), key, make);
  }

  // An elimination order alike.
  template <class Make>
  Result<Order> GetOrder(const std::string& key, Make make) {
    return From(orders_, key, make);
  }

  std::size_t bytes() const {
    const std::scoped_lock lock(mutex_);
    const auto of_system = [](const auto& system) { return system.bytes(); };
    return similarity_.Bytes(of_system) + rigid_.Bytes(of_system) +
           orders_.Bytes([](const auto& order) { return order.capacity() * sizeof(int); });
  }

 private:
  Shelf<GroundedSystem<Complex>>& ShelfOf(Complex*) { return similarity_; }
  Shelf<GroundedSystem<double>>& ShelfOf(double*) { return rigid_; }

  template <class T, class Make>
  Result<std::shared_ptr<const T>> From(Shelf<T>& shelf, const std::string& key, Make make) {
    {
      const std::scoped_lock lock(mutex_);
      if (auto found = shelf.Find(key)) return found;
    }
    Result<T> made = make();
    if (!made) return Fail(std::move(made.error()));
    auto thing = std::make_shared<const T>(*std::move(made));
    const std::scoped_lock lock(mutex_);
    shelf.Put(key, thing);
    return thing;
  }

  mutable std::mutex mutex_;
  Shelf<GroundedSystem<Complex>> similarity_;
  Shelf<GroundedSystem<double>> rigid_;
  Shelf<std::vector<int>> orders_;
};

}  // namespace arap
