// OwnerQuotas: how many sessions, meshes, handle sets and bytes an owner may have in the store, and
// how many sessions all owners together. An owner's open streams are counted in
// streams/open_streams.h, its bytes in memory in derived_cache.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "arap/base/result.h"
#include "arap/model/limits.h"
#include "core/base/mutex.h"
#include "server/access/caller.h"
#include "server/store/store.h"

namespace arap::app {

// Thread-safe. No lock is held while the store counts. Instead whoever is about to store something
// takes a place first and keeps it until the store has answered:
//   - Places that were taken earlier count in full, so that calls that meet never exceed a quota
//     together.
//   - Such a place may be counted twice, once by the store already. Therefore nobody is refused
//     because of it: the call waits until the earlier places have ended and counts again. So a call
//     waits for another one only when the two compete for the last places, and for another owner's
//     only when these are the last of the server, or of the gateway that both belong to.
// Other processes that share the store are counted by what they have stored, not by their places.
class OwnerQuotas {
 public:
  // Both outlive the quotas and these their places.
  OwnerQuotas(const Limits& limits, store::SpecStore& store) : limits_(limits), store_(store) {}

  class Place {
   public:
    Place(Place&& other) noexcept
        : quotas_(std::exchange(other.quotas_, nullptr)), number_(other.number_) {}
    Place& operator=(Place&&) = delete;
    ~Place() {
      if (quotas_ != nullptr) quotas_->Leave(number_);
    }

   private:
    friend class OwnerQuotas;
    Place(OwnerQuotas* quotas, std::uint64_t number) : quotas_(quotas), number_(number) {}

    OwnerQuotas* quotas_;
    std::uint64_t number_;
  };

  // A place for `more`. kLimitExceeded with the quota that is used up: max_sessions_per_owner,
  // max_meshes_per_owner, max_handle_sets_per_owner, max_stored_bytes_per_owner, the same four
  // "_per_gateway" for a caller of a gateway, or max_sessions. When `more` would never fit the
  // fault says so. The faults of the store.
  Result<Place> Take(const Caller& caller, const store::Usage& more);

 private:
  // Who shares a quota.
  enum class Shared { kByOwner, kByGateway, kByAll };
  struct Taken {
    std::string owner;
    std::string gateway;  // empty: of none
    store::Usage more;
  };
  struct Ahead {
    store::Usage owner;    // of the same owner
    store::Usage gateway;  // of the same gateway
    store::Usage all;      // of all owners
  };
  // The quota that leaves no room.
  struct Shortage {
    std::string quota;
    std::size_t limit = 0;
    Shared shared = Shared::kByOwner;
  };

  Place Enter(const Caller& caller, const store::Usage& more);
  void Leave(std::uint64_t number);
  // What places with smaller numbers are for.
  Ahead AheadOf(std::uint64_t number) const;
  Ahead AheadLocked(std::uint64_t number) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void WaitForThoseAhead(std::uint64_t number, Shared shared);
  // With `ahead` counted too.
  Result<std::optional<Shortage>> Find(const Caller& caller, const store::Usage& more,
                                       const Ahead& ahead);

  const Limits& limits_;
  store::SpecStore& store_;
  mutable Mutex mutex_;
  CondVar left_;
  std::map<std::uint64_t, Taken> taken_ ABSL_GUARDED_BY(mutex_);
  std::uint64_t last_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace arap::app
