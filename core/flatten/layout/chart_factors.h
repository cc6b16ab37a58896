// ChartFactors: the factors that one chart is laid flat with, kept or made for it; and FactorCache:
// those of one prepared surface, kept for the next time it is flattened, and the elimination orders
// that they were made with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/flatten.h"
#include "core/base/mutex.h"
#include "core/base/try.h"
#include "core/energy/cells.h"
#include "core/flatten/layout/grounded_system.h"
#include "core/flatten/layout/held.h"
#include "core/flatten/layout/local_global.h"
#include "core/sparse/factor.h"

namespace arap {

// The last few things of one kind, by name.
//
// Things are immutable and shared: one that is evicted lives as long as its users. Not thread-safe.
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

// Thread-safe. Two callers that miss at once both make it; the first one's is kept.
class FactorCache {
 public:
  // At most `capacity` things of each kind; the least recently used goes first. 0 keeps nothing.
  explicit FactorCache(std::size_t capacity)
      : similarity_(capacity), rigid_(capacity), orders_(capacity) {}

  // The factor under `key`, from make() when it is not there. An empty key is never kept.
  template <class Scalar, class Make>
  Result<std::shared_ptr<const GroundedSystem<Scalar>>> Get(const std::string& key, Make make) {
    if constexpr (std::is_same_v<Scalar, Complex>) {
      return From(&FactorCache::similarity_, key, make);
    } else {
      return From(&FactorCache::rigid_, key, make);
    }
  }

  // The same for an elimination order.
  template <class Make>
  Result<Order> GetOrder(const std::string& key, Make make) {
    return From(&FactorCache::orders_, key, make);
  }

  std::size_t bytes() const {
    const MutexLock lock(&mutex_);
    const auto of_system = [](const auto& system) { return system.bytes(); };
    return similarity_.Bytes(of_system) + rigid_.Bytes(of_system) +
           orders_.Bytes([](const auto& order) { return order.capacity() * sizeof(int); });
  }

 private:
  // Makes without the lock: factoring takes long.
  template <class T, class Make>
  Result<std::shared_ptr<const T>> From(Shelf<T> FactorCache::*shelf, const std::string& key,
                                        Make make) {
    {
      const MutexLock lock(&mutex_);
      if (auto found = (this->*shelf).Find(key)) return found;
    }
    TRY(T made, make());
    auto thing = std::make_shared<const T>(std::move(made));
    const MutexLock lock(&mutex_);
    (this->*shelf).Put(key, thing);
    return thing;
  }

  mutable Mutex mutex_;
  Shelf<GroundedSystem<Complex>> similarity_ ABSL_GUARDED_BY(mutex_);
  Shelf<GroundedSystem<double>> rigid_ ABSL_GUARDED_BY(mutex_);
  Shelf<std::vector<int>> orders_ ABSL_GUARDED_BY(mutex_);
};

// Every factor of a chart is made with one elimination order per basis, whatever is held and
// however it is weighted: rounding follows the order, so it must not depend on what was factored
// first. Factors with rigidity are not kept. Faults of all: kNumerical. Not thread-safe; the cache
// is.
class ChartFactors {
 public:
  using SimilarityFactor = std::shared_ptr<const GroundedSystem<Complex>>;

  // `name` tells the chart's factors from those of others in `cache`. Refers to `energy` and
  // `cache`.
  ChartFactors(std::string name, std::size_t vertices, FlattenMethod method,
               const EnergyOptions& energy, FactorCache& cache);

  // The matrix of the first step with `held` (at least two) kept. `assembled` as HeldSystem calls it.
  Result<SimilarityFactor> Holding(const Cells& cells, const Held& held,
                                   const std::function<void()>& assembled = {});

  // The same with nothing kept, for the spectral first step.
  Result<SimilarityFactor> Free(const Cells& cells, const std::function<void()>& assembled = {});

  // The matrix of the rigid step with `held` kept, or `still` where nothing is held. After a first
  // step, whose order it takes. `refining`: `cells` are FACE with cotangents, so that the matrix is
  // the same whatever the energy of the steps before.
  Result<RigidFactor> Rigid(const Cells& cells, const Held& held, std::uint32_t still,
                            bool refining);

  // What was spent on factors that were not there, added up.
  const FactorTimes& times() const { return times_; }

 private:
  int CellBasis() const;
  std::string FirstKey(const char* step, const Held& held) const;
  Result<Order> OrderOf(const Eigen::SparseMatrix<Complex>& lower);
  template <class Scalar>
  Result<GroundedSystem<Scalar>> Timed(Result<GroundedSystem<Scalar>> made);

  const std::string name_;
  const std::size_t vertices_;
  const FlattenMethod method_;
  const EnergyOptions& energy_;
  FactorCache& cache_;
  Order order_;
  FactorTimes times_;
};

}  // namespace arap
