#include "server/budget/owner_quotas.h"

#include "core/base/try.h"
#include "server/budget/faults.h"

namespace arap::app {

OwnerQuotas::Place OwnerQuotas::Enter(const std::string& owner, const store::Usage& more) {
  const MutexLock lock(&mutex_);
  taken_.emplace(++last_, Taken{owner, more});
  return Place(this, last_);
}

void OwnerQuotas::Leave(std::uint64_t number) {
  const MutexLock lock(&mutex_);
  taken_.erase(number);
  left_.SignalAll();
}

OwnerQuotas::Ahead OwnerQuotas::AheadLocked(std::uint64_t number) const {
  Ahead ahead;
  const Taken& mine = taken_.at(number);
  for (const auto& [other, taken] : taken_) {
    if (other == number) break;
    // Only what competes for the same quota.
    if (mine.more.sessions > 0) ahead.sessions += taken.more.sessions;
    if (taken.owner != mine.owner) continue;
    if (mine.more.sessions > 0) ahead.owner.sessions += taken.more.sessions;
    if (mine.more.meshes > 0) ahead.owner.meshes += taken.more.meshes;
    // Only who adds meshes adds bytes that are looked at.
    if (mine.more.bytes > 0) ahead.owner.bytes += taken.more.bytes;
    if (mine.more.handle_sets > 0) ahead.owner.handle_sets += taken.more.handle_sets;
  }
  return ahead;
}

OwnerQuotas::Ahead OwnerQuotas::AheadOf(std::uint64_t number) const {
  const MutexLock lock(&mutex_);
  return AheadLocked(number);
}

void OwnerQuotas::WaitForThoseAhead(std::uint64_t number, bool of_all) {
  const MutexLock lock(&mutex_);
  for (;;) {
    const Ahead ahead = AheadLocked(number);
    const store::Usage& owner = ahead.owner;
    if ((of_all ? ahead.sessions : owner.sessions + owner.meshes + owner.handle_sets) == 0) return;
    left_.Wait(&mutex_);
  }
}

Result<std::optional<OwnerQuotas::Shortage>> OwnerQuotas::Find(const Caller& caller,
                                                               const store::Usage& more,
                                                               const Ahead& ahead) {
  if (more.sessions + more.meshes + more.handle_sets == 0) return std::nullopt;
  TRY(const store::Usage usage, store_.UsageOf(caller.owner));
  const OwnerLimits& most = caller.limits;
  const auto full = [](std::size_t used, std::size_t others, std::size_t wanted,
                       std::size_t limit) { return wanted > 0 && used + others + wanted > limit; };
  if (full(usage.sessions, ahead.owner.sessions, more.sessions, most.max_sessions)) {
    return Shortage{"max_sessions_per_owner", most.max_sessions};
  }
  if (full(usage.meshes, ahead.owner.meshes, more.meshes, most.max_meshes)) {
    return Shortage{"max_meshes_per_owner", most.max_meshes};
  }
  if (full(usage.handle_sets, ahead.owner.handle_sets, more.handle_sets, most.max_handle_sets)) {
    return Shortage{"max_handle_sets_per_owner", most.max_handle_sets};
  }
  if (full(usage.bytes, ahead.owner.bytes, more.bytes, most.max_stored_bytes)) {
    return Shortage{"max_stored_bytes_per_owner", most.max_stored_bytes};
  }
  if (more.sessions == 0) return std::nullopt;
  TRY(const std::size_t count, store_.Count());
  if (full(count, ahead.sessions, more.sessions, limits_.max_sessions)) {
    return Shortage{"max_sessions", limits_.max_sessions, true};
  }
  return std::nullopt;
}

Result<OwnerQuotas::Place> OwnerQuotas::Take(const Caller& caller, const store::Usage& more) {
  if (more.bytes > caller.limits.max_stored_bytes) {
    return Fail(TooLarge("What is to be stored", "max_stored_bytes_per_owner", more.bytes,
                         caller.limits.max_stored_bytes));
  }
  Place place = Enter(caller.owner, more);
  for (;;) {
    TRY(const auto shortage, Find(caller, more, AheadOf(place.number_)));
    if (!shortage) return place;
    // Whatever becomes of the places ahead.
    TRY(const auto certain, Find(caller, more, {}));
    if (certain) return Fail(QuotaFull(certain->quota, certain->limit));
    WaitForThoseAhead(place.number_, shortage->of_all);
  }
}

}  // namespace arap::app
