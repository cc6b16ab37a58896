// DerivedCache: everything heavy that was computed from what is stored — registered meshes,
// compiled handle sets, prepared surfaces — by owner and name, within a budget of bytes.
#pragma once

#include <array>
#include <chrono>
#include <compare>
#include <cstddef>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/access/caller.h"
#include "server/runtime/clock.h"

namespace arap::app {

enum class DerivedKind : std::size_t { kMesh, kHandleSet, kSurface };
inline constexpr std::size_t kDerivedKinds = 3;
const char* NameOf(DerivedKind kind);  // "mesh", "handle_set", "surface"

struct DerivedKey {
  std::string owner;  // nothing is shared between owners, so that nobody sees what another has
  DerivedKind kind = DerivedKind::kMesh;
  std::string name;

  // clang-tidy takes the zero in the generated comparison for a pointer.
  auto operator<=>(const DerivedKey&) const = default;  // NOLINT(modernize-use-nullptr)
};

// Thread-safe. What somebody else still holds is in use: it counts, and it is not evicted, since
// that would give no memory back. Evicting costs time only: whoever needs the thing computes it
// again. What was not used for longest goes first; for the sake of all owners together, of those
// owners that have more than an equal part.
class DerivedCache {
 public:
  // Of one kind, beside the budget of all.
  struct Cap {
    std::size_t entries = static_cast<std::size_t>(-1);
    std::size_t bytes = static_cast<std::size_t>(-1);
  };
  // Told of every look-up and eviction; must not call back.
  struct Listener {
    std::function<void(DerivedKind, bool hit)> looked_up;
    std::function<void(DerivedKind, std::size_t bytes)> evicted;
  };

  // `clock` outlives the cache. `max_bytes` is the budget of all owners together.
  DerivedCache(std::size_t max_bytes, Cap surfaces, const runtime::Clock& clock);

  void Listen(Listener listener);  // before the first use

  // Memory that a job is about to take; given back when this goes.
  class Reservation {
   public:
    Reservation() = default;
    Reservation(Reservation&& other) noexcept { *this = std::move(other); }
    Reservation& operator=(Reservation&& other) noexcept;
    ~Reservation() { Release(); }
    void Release();
    // Gives back all but `bytes`, once what is needed is known.
    void Shrink(std::size_t bytes);

   private:
    friend class DerivedCache;
    Reservation(DerivedCache* cache, std::string owner, std::size_t bytes)
        : cache_(cache), owner_(std::move(owner)), bytes_(bytes) {}
    DerivedCache* cache_ = nullptr;
    std::string owner_;
    std::size_t bytes_ = 0;
  };
  // Makes room for `bytes` of this owner. kLimitExceeded with "max_bytes_per_owner",
  // "max_bytes_per_gateway" or "max_bytes" when what is in use leaves no room.
  Result<Reservation> Reserve(const Caller& caller, std::size_t bytes);
  // Counts `bytes` that are there already, whether or not there is room.
  Reservation Hold(const std::string& owner, std::size_t bytes);
  // As Reserve, for a request of so many bytes: small ones do not count, so that a frame asks for no
  // memory.
  Result<Reservation> ReserveForRequest(const Caller& caller, std::size_t bytes) {
    constexpr std::size_t kSmall = 16u << 10u;
    return Reserve(caller, bytes > kSmall ? bytes : 0);
  }

  // What is kept under the key, or null; counts as a use.
  template <class T>
  std::shared_ptr<const T> Find(const DerivedKey& key) {
    return std::static_pointer_cast<const T>(FindAny(key, true));
  }
  // The same without counting a look-up, for a caller that will Find it soon.
  template <class T>
  std::shared_ptr<const T> Peek(const DerivedKey& key) {
    return std::static_pointer_cast<const T>(FindAny(key, false));
  }
  // Whether it is there; no use, and not counted as a look-up.
  bool Has(const DerivedKey& key) const;
  // Keeps `value`, and evicts what the budget and the cap of its kind ask for. With `replace` in
  // the place of whatever is there; else what is there stays and is returned.
  template <class T>
  std::shared_ptr<const T> Keep(const DerivedKey& key, std::shared_ptr<const T> value,
                                std::size_t bytes, bool replace = false) {
    return std::static_pointer_cast<const T>(KeepAny(key, std::move(value), bytes, replace));
  }
  void Forget(const DerivedKey& key);

  // Evicts what nobody has used for `idle`. Returns the number.
  std::size_t EvictIdle(std::chrono::milliseconds idle);

  std::size_t entries(DerivedKind kind) const;
  std::size_t bytes(DerivedKind kind) const;
  std::size_t bytes() const;  // with reservations and with what is forgotten but in use
  std::size_t bytes_of(const std::string& owner) const;  // likewise

 private:
  using Any = std::shared_ptr<const void>;
  struct Entry {
    DerivedKey key;
    Any value;
    std::size_t bytes = 0;
    runtime::Clock::Steady used;
  };
  using Entries = std::list<Entry>;
  // Forgotten while in use.
  struct Leaving {
    std::string owner;
    std::weak_ptr<const void> value;
    std::size_t bytes = 0;
  };
  struct Held {
    std::size_t entries = 0;
    std::size_t bytes = 0;
  };
  // Values are freed after the lock: they may be large.
  using Garbage = std::vector<Any>;

  Any FindAny(const DerivedKey& key, bool counted);
  Any KeepAny(const DerivedKey& key, Any value, std::size_t bytes, bool replace);

  void RemoveLocked(Entries::iterator entry, Garbage& gone) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void EvictLocked(Entries::iterator entry, Garbage& gone) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Evicts entries for which `counts` says yes until `enough`, which is asked under the lock; false
  // when that cannot be reached.
  bool MakeRoomLocked(const std::function<bool()>& enough,
                      const std::function<bool(const Entry&)>& counts, Garbage& gone)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void DropLeftLocked() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::size_t UsedLocked() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  std::size_t UsedLocked(const std::string& owner) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // By a gateway and its users.
  std::size_t UsedUnderLocked(const std::string& gateway) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void TrimLocked(Garbage& gone) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The same for the sake of all owners.
  bool MakeRoomOfAllLocked(const std::function<bool()>& enough, Garbage& gone)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // The entry of this kind that has to go when there are too many, or too many bytes, of it.
  Entries::iterator SurplusLocked(DerivedKind kind, bool by_bytes)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool MakeRoomOfGatewayLocked(const Gateway& gateway, std::size_t bytes, Garbage& gone)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void GiveBack(const std::string& owner, std::size_t bytes);
  void CountLocked(const std::string& owner, std::size_t bytes)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void UncountLocked(const std::string& owner, std::size_t bytes)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::size_t max_bytes_;
  const Cap surfaces_;
  const runtime::Clock& clock_;
  Listener listener_;
  mutable Mutex mutex_;
  // The last used first.
  Entries entries_ ABSL_GUARDED_BY(mutex_);
  std::map<DerivedKey, Entries::iterator> by_key_ ABSL_GUARDED_BY(mutex_);
  std::array<Held, kDerivedKinds> held_ ABSL_GUARDED_BY(mutex_);
  // Of entries and reservations.
  std::map<std::string, std::size_t> owner_bytes_ ABSL_GUARDED_BY(mutex_);
  // The same for a gateway and its users together (PayerOf).
  std::map<std::string, std::size_t, std::less<>> payer_bytes_ ABSL_GUARDED_BY(mutex_);
  std::size_t reserved_ ABSL_GUARDED_BY(mutex_) = 0;
  std::vector<Leaving> leaving_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::app
