// StoreKeeper: keeps what is stored from harm. It asks the store again and again what it says of
// itself, and takes blobs away only when nothing speaks against it.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "server/runtime/clock.h"
#include "server/store/store.h"

namespace arap::store {

// Blobs that no record names are set aside after ten minutes, for a registration puts its blob
// before the record that names it, and removed a day later. Half of all blobs at once are not set
// aside, nor are they within the hour in which that is wanted for the first time.
inline constexpr SweepRules kSweepRules{
    .age = std::chrono::minutes(10), .aside = std::chrono::hours(24), .share = 0.5, .few = 64};
inline constexpr std::chrono::minutes kHoldBack{60};

// A server whose clock differs more from the store's is not to be sent new work.
inline constexpr std::chrono::seconds kMaxSkew{30};

// Thread-safe; Look and Collect wait for the store.
class StoreKeeper {
 public:
  // All outlive it. With `allow_lossy` a store that may lose what it has acknowledged is no reason
  // to send no work.
  StoreKeeper(SpecStore& specs, BlobStore& blobs, const runtime::Clock& clock, bool allow_lossy);

  // Asks the store about itself unless it has answered within the last ten seconds. The faults of
  // the store, which leave what is known as it was.
  Status Look();

  // Takes away blobs that no record names, by these rules. Nothing when the blobs are another
  // store's, and nothing while too many would go for the first time. Answers the store's faults.
  Result<SweepReport> Collect(const SweepRules& rules);

  // What is wrong with the store by what is known now. Never blocks.
  std::vector<Weakness> weaknesses() const;

 private:
  // The store's word, with what this server sees beside it.
  Result<std::vector<Weakness>> Ask();
  // Whether the blobs are this store's.
  Result<bool> Owns(const StoreFacts& facts);

  SpecStore& specs_;
  BlobStore& blobs_;
  const runtime::Clock& clock_;
  const bool allow_lossy_;
  mutable Mutex mutex_;
  std::optional<runtime::Clock::Steady> asked_ ABSL_GUARDED_BY(mutex_);
  std::vector<Weakness> known_ ABSL_GUARDED_BY(mutex_);
  // Since when, and how many, blobs are held back.
  std::optional<runtime::Clock::Steady> held_since_ ABSL_GUARDED_BY(mutex_);
  SweepReport held_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::store
