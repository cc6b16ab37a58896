#include "server/streams/open_streams.h"

#include <utility>

#include "server/budget/faults.h"

namespace arap::app {
namespace {

// The session is in the store: the same open works on whichever server takes the next connection.
Fault Draining() {
  return Fault(FaultKind::kDraining, "The server is shutting down; open again elsewhere.")
      .Detail("resume", "open_again");
}

}  // namespace

Status OpenStreams::Add(const std::shared_ptr<LongCall>& call, const Caller& caller) {
  const MutexLock lock(&mutex_);
  if (draining_) return Fail(Draining());
  if (calls_.size() >= limit_) return Fail(QuotaFull("max_streams", limit_));
  const auto owned = by_owner_.find(caller.owner);
  if (owned != by_owner_.end() && owned->second >= caller.limits.max_streams) {
    return Fail(QuotaFull("max_streams_per_owner", caller.limits.max_streams));
  }
  if (const auto& gateway = caller.gateway;
      gateway && SumOf(by_owner_, gateway->owner) >= gateway->limits.max_streams) {
    return Fail(QuotaFull("max_streams_per_gateway", gateway->limits.max_streams));
  }
  calls_.emplace(call.get(), Entry{call, caller.owner});
  ++by_owner_[caller.owner];
  return {};
}

void OpenStreams::Remove(const LongCall* call) {
  const MutexLock lock(&mutex_);
  const auto found = calls_.find(call);
  if (found == calls_.end()) return;
  const auto owned = by_owner_.find(found->second.owner);
  if (--owned->second == 0) by_owner_.erase(owned);
  calls_.erase(found);
}

OpenStreams::Alive OpenStreams::AliveOnes() const {
  Alive open;
  for (const auto& [key, entry] : calls_) {
    if (auto alive = entry.call.lock()) open.push_back(std::move(alive));
  }
  return open;
}

void OpenStreams::Drain() {
  Alive open;
  {
    const MutexLock lock(&mutex_);
    draining_ = true;
    open = AliveOnes();
  }
  for (const auto& call : open) call->End(Draining());
}

void OpenStreams::Sweep(runtime::Clock::Steady now) {
  Alive open;
  {
    const MutexLock lock(&mutex_);
    open = AliveOnes();
  }
  for (const auto& call : open) call->Sweep(now);
}

std::size_t OpenStreams::count() const {
  const MutexLock lock(&mutex_);
  return calls_.size();
}

}  // namespace arap::app
