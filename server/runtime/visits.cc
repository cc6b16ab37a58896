// Work of a lane that is done in the thread that asks for it, so that no worker has to be woken.
#include <algorithm>
#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "server/runtime/metrics.h"
#include "server/runtime/worker_pool.h"

namespace arap::runtime {
namespace {

using std::chrono::steady_clock;

// Whatever a thread begins to do sooner after a visit was waiting behind it.
constexpr std::chrono::microseconds kBreath{30};
thread_local steady_clock::time_point last_visit{};

}  // namespace

bool WorkerPool::OwnerRunsLocked(const std::string& owner) const {
  return std::any_of(jobs_.begin(), jobs_.end(),
                     [&](const std::optional<Running>& job) { return job && job->owner == owner; });
}

WorkerPool::Visit WorkerPool::TryVisit(Share share) {
  if (options_.visitors == 0 || share.seconds > options_.visit_seconds) return nullptr;
  const Time now = steady_clock::now();
  if (now - last_visit < kBreath) return nullptr;
  std::unique_ptr<Worker> worker;
  {
    const MutexLock lock(&mutex_);
    if (stopped_ || visitors_ == options_.visitors || !queue_.WouldBeNext(share.owner))
      return nullptr;
    if (!HasPlaceLocked() && !HasShortPlaceLocked() && OwnerRunsLocked(share.owner)) return nullptr;
    worker = std::make_unique<Worker>(Worker{*this, 0});
    worker->share = std::move(share);
    worker->since = worker->turn = worker->clock = now;
    worker->paid = Queue::Paid(worker->share);
    // It comes and is taken, as everybody's job.
    queue_.Push({worker->share, now, {}}, false);
    queue_.Pop();
    worker->thread = jobs_.size() - options_.visitors;
    while (jobs_[worker->thread]) ++worker->thread;
    jobs_[worker->thread] = Running{now, worker->share.seconds, worker->share.owner};
    ++visitors_;
  }
  if (options_.metrics != nullptr) options_.metrics->Queue(options_.name, 0);
  return Visit(worker.release());
}

void WorkerPool::EndVisit(Worker& worker) {
  const MutexLock lock(&mutex_);
  NoteEndLocked(worker);
  --visitors_;
  last_visit = worker.clock;
}

void WorkerPool::EndOfVisit::operator()(Worker* worker) const {
  worker->pool.EndVisit(*worker);
  delete worker;
}

}  // namespace arap::runtime
