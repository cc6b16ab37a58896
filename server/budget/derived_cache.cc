#include "server/budget/derived_cache.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "core/base/names.h"
#include "server/budget/faults.h"

namespace arap::app {

const char* NameOf(DerivedKind kind) {
  switch (kind) {
    case DerivedKind::kMesh:
      return "mesh";
    case DerivedKind::kHandleSet:
      return "handle_set";
    case DerivedKind::kSurface:
      return "surface";
  }
  return "unknown";
}

DerivedCache::DerivedCache(std::size_t max_bytes, Cap surfaces, const runtime::Clock& clock)
    : max_bytes_(max_bytes), surfaces_(surfaces), clock_(clock) {}

void DerivedCache::Listen(Listener listener) { listener_ = std::move(listener); }

DerivedCache::Reservation& DerivedCache::Reservation::operator=(Reservation&& other) noexcept {
  if (this == &other) return *this;
  Release();
  cache_ = std::exchange(other.cache_, nullptr);
  owner_ = std::move(other.owner_);
  bytes_ = std::exchange(other.bytes_, 0);
  return *this;
}

void DerivedCache::Reservation::Release() {
  if (DerivedCache* cache = std::exchange(cache_, nullptr)) cache->GiveBack(owner_, bytes_);
}

void DerivedCache::Reservation::Shrink(std::size_t bytes) {
  if (cache_ == nullptr || bytes >= bytes_) return;
  cache_->GiveBack(owner_, bytes_ - bytes);
  bytes_ = bytes;
}

DerivedCache::Reservation DerivedCache::Hold(const std::string& owner, std::size_t bytes) {
  if (bytes == 0) return {};
  const MutexLock lock(&mutex_);
  reserved_ += bytes;
  CountLocked(owner, bytes);
  return Reservation(this, owner, bytes);
}

void DerivedCache::GiveBack(const std::string& owner, std::size_t bytes) {
  const MutexLock lock(&mutex_);
  reserved_ -= bytes;
  UncountLocked(owner, bytes);
}

void DerivedCache::CountLocked(const std::string& owner, std::size_t bytes) {
  owner_bytes_[owner] += bytes;
  payer_bytes_[std::string(PayerOf(owner))] += bytes;
}

void DerivedCache::UncountLocked(const std::string& owner, std::size_t bytes) {
  const auto found = owner_bytes_.find(owner);
  if ((found->second -= bytes) == 0) owner_bytes_.erase(found);
  const auto payer = payer_bytes_.find(PayerOf(owner));
  if ((payer->second -= bytes) == 0) payer_bytes_.erase(payer);
}

Result<DerivedCache::Reservation> DerivedCache::Reserve(const Caller& caller, std::size_t bytes) {
  if (bytes == 0) return Reservation();
  Garbage gone;
  const MutexLock lock(&mutex_);
  DropLeftLocked();
  const std::size_t most = caller.limits.max_bytes;
  const auto owner_fits = [&] {
    mutex_.AssertHeld();
    const std::size_t used = UsedLocked(caller.owner);
    return used <= most && bytes <= most - used;
  };
  const auto all_fit = [&] {
    mutex_.AssertHeld();
    const std::size_t used = UsedLocked();
    return used <= max_bytes_ && bytes <= max_bytes_ - used;
  };
  const auto refuse = [&](const char* quota, std::size_t limit) {
    Fault full = QuotaFull(quota, limit).Detail("estimate", bytes);
    return Fail(bytes > limit ? ForEver(std::move(full)) : std::move(full));
  };
  // What could never fit must not push others out.
  if (bytes > most) return refuse("max_bytes_per_owner", most);
  if (caller.gateway && bytes > caller.gateway->limits.max_bytes) {
    return refuse("max_bytes_per_gateway", caller.gateway->limits.max_bytes);
  }
  if (bytes > max_bytes_) return refuse("max_bytes", max_bytes_);
  if (!MakeRoomLocked(
          owner_fits, [&](const Entry& e) { return e.key.owner == caller.owner; }, gone)) {
    return refuse("max_bytes_per_owner", most);
  }
  if (caller.gateway && !MakeRoomOfGatewayLocked(*caller.gateway, bytes, gone)) {
    return refuse("max_bytes_per_gateway", caller.gateway->limits.max_bytes);
  }
  if (!MakeRoomOfAllLocked(all_fit, gone)) return refuse("max_bytes", max_bytes_);
  reserved_ += bytes;
  CountLocked(caller.owner, bytes);
  return Reservation(this, caller.owner, bytes);
}

bool DerivedCache::MakeRoomOfGatewayLocked(const Gateway& gateway, std::size_t bytes,
                                           Garbage& gone) {
  const std::size_t most = gateway.limits.max_bytes;
  const auto fits = [&] {
    mutex_.AssertHeld();
    const std::size_t used = UsedUnderLocked(gateway.owner);
    return used <= most && bytes <= most - used;
  };
  const auto belongs = [&gateway](const Entry& e) { return BelongsTo(e.key.owner, gateway.owner); };
  std::size_t users = 1;
  for (const auto& [owner, has] : owner_bytes_) users += BelongsTo(owner, gateway.owner) ? 1U : 0U;
  const auto more_than_a_part = [&](const Entry& e) {
    mutex_.AssertHeld();
    const auto has = owner_bytes_.find(e.key.owner);
    return belongs(e) && has != owner_bytes_.end() && has->second > most / users;
  };
  return MakeRoomLocked(fits, more_than_a_part, gone) || MakeRoomLocked(fits, belongs, gone);
}

bool DerivedCache::MakeRoomLocked(const std::function<bool()>& enough,
                                  const std::function<bool(const Entry&)>& counts, Garbage& gone) {
  // A set holds its mesh: when it has gone, the mesh may go too, so it is asked again. The garbage
  // must not count as a holder.
  for (bool progress = true; progress && !enough();) {
    progress = false;
    for (auto entry = entries_.end(); entry != entries_.begin() && !enough();) {
      --entry;
      if (entry->value.use_count() > 1 || !counts(*entry)) continue;
      const auto next = std::next(entry);
      EvictLocked(entry, gone);
      entry = next;
      progress = true;
    }
  }
  return enough();
}

void DerivedCache::RemoveLocked(Entries::iterator entry, Garbage& gone) {
  Held& held = held_[static_cast<std::size_t>(entry->key.kind)];
  --held.entries;
  held.bytes -= entry->bytes;
  UncountLocked(entry->key.owner, entry->bytes);
  if (entry->value.use_count() > 1) {
    leaving_.push_back({entry->key.owner, entry->value, entry->bytes});
  }
  by_key_.erase(entry->key);
  gone.push_back(std::move(entry->value));
  entries_.erase(entry);
}

void DerivedCache::EvictLocked(Entries::iterator entry, Garbage& gone) {
  const DerivedKind kind = entry->key.kind;
  if (listener_.evicted) listener_.evicted(kind, entry->bytes);
  RemoveLocked(entry, gone);
  // Freed at once and not after the lock: only then does it release its mesh.
  if (kind == DerivedKind::kHandleSet) gone.pop_back();
}

void DerivedCache::DropLeftLocked() {
  std::erase_if(leaving_, [](const Leaving& one) { return one.value.expired(); });
}

std::size_t DerivedCache::UsedLocked() const {
  std::size_t used = reserved_;
  for (const Held& held : held_) used += held.bytes;
  for (const Leaving& one : leaving_) used += one.value.expired() ? 0 : one.bytes;
  return used;
}

std::size_t DerivedCache::UsedLocked(const std::string& owner) const {
  const auto found = owner_bytes_.find(owner);
  std::size_t used = found == owner_bytes_.end() ? 0 : found->second;
  for (const Leaving& one : leaving_) {
    used += one.owner == owner && !one.value.expired() ? one.bytes : 0;
  }
  return used;
}

std::size_t DerivedCache::UsedUnderLocked(const std::string& gateway) const {
  const auto found = payer_bytes_.find(gateway);
  std::size_t used = found == payer_bytes_.end() ? 0 : found->second;
  for (const Leaving& one : leaving_) {
    used += BelongsTo(one.owner, gateway) && !one.value.expired() ? one.bytes : 0;
  }
  return used;
}

DerivedCache::Any DerivedCache::FindAny(const DerivedKey& key, bool counted) {
  const MutexLock lock(&mutex_);
  const auto found = by_key_.find(key);
  const bool hit = found != by_key_.end();
  if (counted && listener_.looked_up) listener_.looked_up(key.kind, hit);
  if (!hit) return nullptr;
  found->second->used = clock_.SteadyNow();
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->value;
}

bool DerivedCache::Has(const DerivedKey& key) const {
  const MutexLock lock(&mutex_);
  return by_key_.contains(key);
}

DerivedCache::Any DerivedCache::KeepAny(const DerivedKey& key, Any value, std::size_t bytes,
                                        bool replace) {
  Garbage gone;
  const MutexLock lock(&mutex_);
  if (const auto found = by_key_.find(key); found != by_key_.end()) {
    if (!replace) return found->second->value;
    // The same value kept again: the list's own reference must not pass for somebody else's.
    if (found->second->value == value) found->second->value.reset();
    RemoveLocked(found->second, gone);
  }
  const bool capped = key.kind == DerivedKind::kSurface;
  if (capped && (surfaces_.entries == 0 || bytes > surfaces_.bytes)) return value;
  entries_.push_front({key, value, bytes, clock_.SteadyNow()});
  by_key_.emplace(key, entries_.begin());
  Held& held = held_[static_cast<std::size_t>(key.kind)];
  ++held.entries;
  held.bytes += bytes;
  CountLocked(key.owner, bytes);
  if (capped) {
    // The cap counts places, so that one in use goes too.
    while (held.entries > surfaces_.entries || held.bytes > surfaces_.bytes) {
      EvictLocked(SurplusLocked(key.kind, held.bytes > surfaces_.bytes), gone);
    }
  }
  TrimLocked(gone);
  return value;
}

DerivedCache::Entries::iterator DerivedCache::SurplusLocked(DerivedKind kind, bool by_bytes) {
  // Who has most of those that `counts` says yes to, by the name that `of` gives an owner.
  const auto most = [&](auto of, auto counts) {
    mutex_.AssertHeld();
    std::map<std::string_view, std::size_t> has;
    for (const Entry& entry : entries_) {
      if (entry.key.kind == kind && counts(entry)) {
        has[of(entry.key.owner)] += by_bytes ? entry.bytes : 1;
      }
    }
    return std::max_element(has.begin(), has.end(),
                            [](const auto& a, const auto& b) { return a.second < b.second; })
        ->first;
  };
  const std::string_view payer = most(PayerOf, [](const Entry&) { return true; });
  const std::string_view owner =
      most([](const std::string& name) { return std::string_view(name); },
           [payer](const Entry& entry) { return PayerOf(entry.key.owner) == payer; });
  auto oldest = std::prev(entries_.end());
  while (oldest->key.kind != kind || oldest->key.owner != owner) --oldest;
  return oldest;
}

bool DerivedCache::MakeRoomOfAllLocked(const std::function<bool()>& enough, Garbage& gone) {
  const auto more_than_a_part = [this](const Entry& entry) {
    mutex_.AssertHeld();
    const auto has = payer_bytes_.find(PayerOf(entry.key.owner));
    return has != payer_bytes_.end() && has->second > max_bytes_ / payer_bytes_.size();
  };
  return MakeRoomLocked(enough, more_than_a_part, gone) ||
         MakeRoomLocked(
             enough, [](const Entry&) { return true; }, gone);
}

void DerivedCache::TrimLocked(Garbage& gone) {
  const auto fits = [this] {
    mutex_.AssertHeld();
    return UsedLocked() <= max_bytes_;
  };
  MakeRoomOfAllLocked(fits, gone);
}

void DerivedCache::Forget(const DerivedKey& key) {
  Garbage gone;
  const MutexLock lock(&mutex_);
  DropLeftLocked();
  if (const auto found = by_key_.find(key); found != by_key_.end()) {
    RemoveLocked(found->second, gone);
  }
}

std::size_t DerivedCache::EvictIdle(std::chrono::milliseconds idle) {
  Garbage gone;
  const MutexLock lock(&mutex_);
  DropLeftLocked();
  const runtime::Clock::Steady now = clock_.SteadyNow();
  std::size_t evicted = 0;
  // Sets first: they hold their meshes.
  for (const bool sets : {true, false}) {
    for (auto entry = entries_.begin(); entry != entries_.end();) {
      const auto next = std::next(entry);
      if ((entry->key.kind == DerivedKind::kHandleSet) == sets) {
        if (entry->value.use_count() > 1) {
          entry->used = now;
        } else if (now - entry->used >= idle) {
          EvictLocked(entry, gone);
          ++evicted;
        }
      }
      entry = next;
    }
  }
  return evicted;
}

std::size_t DerivedCache::entries(DerivedKind kind) const {
  const MutexLock lock(&mutex_);
  return held_[static_cast<std::size_t>(kind)].entries;
}

std::size_t DerivedCache::bytes(DerivedKind kind) const {
  const MutexLock lock(&mutex_);
  return held_[static_cast<std::size_t>(kind)].bytes;
}

std::size_t DerivedCache::bytes() const {
  const MutexLock lock(&mutex_);
  return UsedLocked();
}

std::size_t DerivedCache::bytes_of(const std::string& owner) const {
  const MutexLock lock(&mutex_);
  return UsedLocked(owner);
}

}  // namespace arap::app
