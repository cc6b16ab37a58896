#include "server/app/open_streams.h"

#include <vector>

#include "server/app/names.h"

namespace arap::app {
namespace {

Fault Draining() {
  return {FaultKind::kDraining, "The server is shutting down; connect again.", {}, {}, {}};
}

}  // namespace

Status OpenStreams::Add(const std::shared_ptr<OpenStream>& stream) {
  const std::lock_guard lock(mutex_);
  if (draining_) return Fail(Draining());
  if (streams_.size() >= limit_) return Fail(QuotaFull("max_streams", limit_));
  streams_.emplace(stream.get(), stream);
  return {};
}

void OpenStreams::Remove(const OpenStream* stream) {
  const std::lock_guard lock(mutex_);
  streams_.erase(stream);
}

void OpenStreams::Drain() {
  std::vector<std::shared_ptr<OpenStream>> open;
  {
    const std::lock_guard lock(mutex_);
    draining_ = true;
    for (const auto& [key, stream] : streams_) {
      if (auto alive = stream.lock()) open.push_back(std::move(alive));
    }
  }
  for (const auto& stream : open) stream->End(Draining());
}

std::size_t OpenStreams::count() const {
  const std::lock_guard lock(mutex_);
  return streams_.size();
}

}  // namespace arap::app
