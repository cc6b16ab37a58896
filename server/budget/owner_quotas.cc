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
    if (mine.more.handle_sets > 0) ahead.owner.handle_sets += taken.more.handle_sets;
  }
  return ahead;
}

OwnerQuotas::Ahead OwnerQuotas::AheadOf(std::uint64_t number) const {
  const MutexLock lock(&mutex_);
  return AheadLocked(number);
}

void OwnerQuotas::WaitForThoseAhead(std::uint64_t number) {
  const MutexLock lock(&mutex_);
  while (AheadLocked(number).any()) left_.Wait(&mutex_);
}

Status OwnerQuotas::Check(const Caller& caller, const store::Usage& more, const Ahead& ahead) {
  if (more.sessions + more.meshes + more.handle_sets == 0) return {};
  TRY(const store::Usage usage, store_.UsageOf(caller.owner));
  const OwnerLimits& owner = caller.limits;
  if (more.sessions > 0) {
    TRY(const std::size_t count, store_.Count());
    if (usage.sessions + ahead.owner.sessions + more.sessions > owner.max_sessions) {
      return Fail(QuotaFull("max_sessions_per_owner", owner.max_sessions));
    }
    if (count + ahead.sessions + more.sessions > limits_.max_sessions) {
      return Fail(QuotaFull("max_sessions", limits_.max_sessions));
    }
  }
  if (more.meshes > 0 && usage.meshes + ahead.owner.meshes + more.meshes > owner.max_meshes) {
    return Fail(QuotaFull("max_meshes_per_owner", owner.max_meshes));
  }
  if (more.handle_sets > 0 &&
      usage.handle_sets + ahead.owner.handle_sets + more.handle_sets > owner.max_handle_sets) {
    return Fail(QuotaFull("max_handle_sets_per_owner", owner.max_handle_sets));
  }
  return {};
}

Result<OwnerQuotas::Place> OwnerQuotas::Take(const Caller& caller, const store::Usage& more) {
  Place place = Enter(caller.owner, more);
  const Ahead ahead = AheadOf(place.number_);
  Status room = Check(caller, more, ahead);
  if (!room && room.error().kind == FaultKind::kLimitExceeded && ahead.any()) {
    WaitForThoseAhead(place.number_);
    room = Check(caller, more, {});
  }
  CHECK_OK(room);
  return place;
}

}  // namespace arap::app
