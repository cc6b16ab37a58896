#include "server/streams/open_streams.h"

#include <utility>

#include "server/sessions/names.h"

namespace arap::app {
namespace {

// The session is in the store: the same open works on whichever server takes the next connection.
Fault Draining() {
  Fault fault(FaultKind::kDraining, "The server is shutting down; open again elsewhere.");
  return fault.Detail("resume", "open_again");
}

}  // namespace

Status OpenStreams::Add(const std::shared_ptr<OpenStream>& stream, const Caller& caller) {
  const std::lock_guard lock(mutex_);
  if (draining_) return Fail(Draining());
  if (streams_.size() >= limit_) return Fail(QuotaFull("max_streams", limit_));
  const auto owned = by_owner_.find(caller.owner);
  if (owned != by_owner_.end() && owned->second >= caller.limits.max_streams) {
    return Fail(QuotaFull("max_streams_per_owner", caller.limits.max_streams));
  }
  streams_.emplace(stream.get(), Entry{stream, caller.owner});
  ++by_owner_[caller.owner];
  return {};
}

void OpenStreams::Remove(const OpenStream* stream) {
  const std::lock_guard lock(mutex_);
  const auto found = streams_.find(stream);
  if (found == streams_.end()) return;
  const auto owned = by_owner_.find(found->second.owner);
  if (--owned->second == 0) by_owner_.erase(owned);
  streams_.erase(found);
}

std::vector<std::shared_ptr<OpenStream>> OpenStreams::AliveLocked() const {
  std::vector<std::shared_ptr<OpenStream>> open;
  for (const auto& [key, entry] : streams_) {
    if (auto alive = entry.stream.lock()) open.push_back(std::move(alive));
  }
  return open;
}

void OpenStreams::Drain() {
  std::vector<std::shared_ptr<OpenStream>> open;
  {
    const std::lock_guard lock(mutex_);
    draining_ = true;
    open = AliveLocked();
  }
  for (const auto& stream : open) stream->End(Draining());
}

void OpenStreams::Sweep(runtime::Clock::Steady now) {
  std::vector<std::shared_ptr<OpenStream>> open;
  {
    const std::lock_guard lock(mutex_);
    open = AliveLocked();
  }
  for (const auto& stream : open) stream->Sweep(now);
}

std::size_t OpenStreams::count() const {
  const std::lock_guard lock(mutex_);
  return streams_.size();
}

}  // namespace arap::app
