#include "server/runtime/helpers.h"

#include <algorithm>
#include <chrono>

#include "core/base/cpu_timer.h"

namespace arap::runtime {

struct WorkerPool::Offer {
  void (*call)(const void* part, std::size_t index);
  const void* part;
  std::size_t parts;
  std::size_t most;         // threads beside the one whose offer it is
  std::size_t next = 0;     // the first part that nobody has taken
  std::size_t helping = 0;  // threads that are at a part
  double seconds = 0;       // of the processor, that they have taken
  CondVar done{};           // nobody helps any more
};

bool WorkerPool::HelpLocked() {
  // A processor for every job, for everybody who is helped and for every helper.
  if (running_ + helping_ + offers_.size() >= options_.threads) return false;
  const auto found = std::find_if(offers_.begin(), offers_.end(), [](const Offer* each) {
    return each->next < each->parts && each->helping < each->most;
  });
  if (found == offers_.end()) return false;
  Offer& offer = **found;
  const std::size_t index = offer.next++;
  ++offer.helping;
  ++helping_;
  mutex_.Unlock();
  CpuTimer processor;
  offer.call(offer.part, index);
  const double seconds = processor.Lap() * 1e-3;
  mutex_.Lock();
  --helping_;
  offer.seconds += seconds;
  busy_ += std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(seconds));
  ++helped_;
  // Under the lock, for the offer goes when its thread has it.
  if (--offer.helping == 0) offer.done.Signal();
  return true;
}

void WorkerPool::RunOffer(Offer& offer) {
  {
    const MutexLock lock(&mutex_);
    offers_.push_back(&offer);
  }
  for (std::size_t i = 0; i < offer.most && i + 1 < offer.parts; ++i) wake_.Signal();
  const MutexLock lock(&mutex_);
  while (offer.next < offer.parts) {
    const std::size_t index = offer.next++;
    mutex_.Unlock();
    offer.call(offer.part, index);
    mutex_.Lock();
  }
  offers_.erase(std::find(offers_.begin(), offers_.end(), &offer));
  while (offer.helping > 0) offer.done.Wait(&mutex_);
}

Helpers::Helpers() : pool_(WorkerPool::OthersHere()) {
  if (pool_ != nullptr) most_ = pool_->options_.threads - 1;
}

void Helpers::RunParts(std::size_t parts, Call call, const void* part) {
  WorkerPool::Offer offer{call, part, parts, most_};
  pool_->RunOffer(offer);
  seconds_ += offer.seconds;
  WorkerPool::ChargeHere(offer.seconds);
}

}  // namespace arap::runtime
