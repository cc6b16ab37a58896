#include "server/budget/owner_quotas.h"

#include "core/base/try.h"
#include "server/budget/faults.h"

namespace arap::app {

namespace {

// What competes with `wanted`.
store::Usage CompetingPart(const store::Usage& more, const store::Usage& wanted) {
  store::Usage part;
  if (wanted.sessions > 0) part.sessions = more.sessions;
  if (wanted.meshes > 0) part.meshes = more.meshes;
  if (wanted.handle_sets > 0) part.handle_sets = more.handle_sets;
  if (wanted.bytes > 0) part.bytes = more.bytes;
  return part;
}

struct QuotaRow {
  const char* name;
  std::size_t store::Usage::*used;
  std::size_t OwnerLimits::*limit;
};
constexpr QuotaRow kQuotas[] = {
    {"max_sessions", &store::Usage::sessions, &OwnerLimits::max_sessions},
    {"max_meshes", &store::Usage::meshes, &OwnerLimits::max_meshes},
    {"max_handle_sets", &store::Usage::handle_sets, &OwnerLimits::max_handle_sets},
    {"max_stored_bytes", &store::Usage::bytes, &OwnerLimits::max_stored_bytes},
};

// The row that has no room for `more`, or null.
const QuotaRow* FullRow(const store::Usage& used, const store::Usage& more,
                        const OwnerLimits& most) {
  for (const QuotaRow& row : kQuotas) {
    if (more.*row.used > 0 && used.*row.used + more.*row.used > most.*row.limit) return &row;
  }
  return nullptr;
}

}  // namespace

OwnerQuotas::Place OwnerQuotas::Enter(const Caller& caller, const store::Usage& more) {
  const MutexLock lock(&mutex_);
  const std::string gateway = caller.gateway ? caller.gateway->owner : "";
  taken_.emplace(++last_, Taken{caller.owner, gateway, more});
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
    const store::Usage part = CompetingPart(taken.more, mine.more);
    ahead.all.sessions += part.sessions;
    if (!mine.gateway.empty() && BelongsTo(taken.owner, mine.gateway)) ahead.gateway += part;
    if (taken.owner == mine.owner) ahead.owner += part;
  }
  return ahead;
}

OwnerQuotas::Ahead OwnerQuotas::AheadOf(std::uint64_t number) const {
  const MutexLock lock(&mutex_);
  return AheadLocked(number);
}

void OwnerQuotas::WaitForThoseAhead(std::uint64_t number, Shared shared) {
  const MutexLock lock(&mutex_);
  for (;;) {
    const Ahead ahead = AheadLocked(number);
    const store::Usage& those = shared == Shared::kByOwner     ? ahead.owner
                                : shared == Shared::kByGateway ? ahead.gateway
                                                               : ahead.all;
    if (those.sessions + those.meshes + those.handle_sets + those.bytes == 0) return;
    left_.Wait(&mutex_);
  }
}

Result<std::optional<OwnerQuotas::Shortage>> OwnerQuotas::Find(const Caller& caller,
                                                               const store::Usage& more,
                                                               const Ahead& ahead) {
  if (more.sessions + more.meshes + more.handle_sets + more.bytes == 0) return std::nullopt;
  TRY(store::Usage used, store_.UsageOf(caller.owner));
  used += ahead.owner;
  if (const QuotaRow* full = FullRow(used, more, caller.limits)) {
    return Shortage{std::string(full->name) + "_per_owner", caller.limits.*full->limit,
                    Shared::kByOwner};
  }
  if (caller.gateway) {
    const OwnerLimits& most = caller.gateway->limits;
    TRY(store::Usage together, store_.UsageUnder(caller.gateway->owner));
    together += ahead.gateway;
    if (const QuotaRow* full = FullRow(together, more, most)) {
      return Shortage{std::string(full->name) + "_per_gateway", most.*full->limit,
                      Shared::kByGateway};
    }
  }
  if (more.sessions == 0) return std::nullopt;
  TRY(const std::size_t count, store_.Count());
  if (count + ahead.all.sessions + more.sessions > limits_.max_sessions) {
    return Shortage{"max_sessions", limits_.max_sessions, Shared::kByAll};
  }
  return std::nullopt;
}

Result<OwnerQuotas::Place> OwnerQuotas::Take(const Caller& caller, const store::Usage& more) {
  const auto never_fits = [&more](const char* quota, const OwnerLimits& most) {
    return TooLarge("What is to be stored", quota, more.bytes, most.max_stored_bytes);
  };
  if (more.bytes > caller.limits.max_stored_bytes) {
    return Fail(never_fits("max_stored_bytes_per_owner", caller.limits));
  }
  if (caller.gateway && more.bytes > caller.gateway->limits.max_stored_bytes) {
    return Fail(never_fits("max_stored_bytes_per_gateway", caller.gateway->limits));
  }
  Place place = Enter(caller, more);
  for (;;) {
    TRY(const auto shortage, Find(caller, more, AheadOf(place.number_)));
    if (!shortage) return place;
    // Whatever becomes of the places ahead.
    TRY(const auto certain, Find(caller, more, {}));
    if (certain) return Fail(QuotaFull(certain->quota, certain->limit));
    WaitForThoseAhead(place.number_, shortage->shared);
  }
}

}  // namespace arap::app
