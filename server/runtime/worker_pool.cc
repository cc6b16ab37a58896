#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <pthread.h>

#include "server/runtime/metrics.h"

namespace arap::runtime {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

// What GiveWay knows of the thread that calls it.
struct Worker {
  WorkerPool* pool = nullptr;
  WorkerPool* gives_way_to = nullptr;
  steady_clock::time_point next;  // when it may wait again
};
thread_local Worker this_worker;

PoolOptions WithThread(PoolOptions options) {
  options.threads = std::max<std::size_t>(options.threads, 1);
  return options;
}

void NameThread(const std::string& name) {
  constexpr std::size_t kLongestName = 15;
  pthread_setname_np(pthread_self(), name.substr(0, kLongestName).c_str());
}

}  // namespace

void GiveWay() {
  Worker& worker = this_worker;
  if (worker.gives_way_to == nullptr) return;
  const auto begin = steady_clock::now();
  if (begin < worker.next) return;
  if (worker.gives_way_to->AwaitFreeThread(std::chrono::milliseconds::zero())) return;
  {
    const MutexLock lock(&worker.pool->mutex_);
    ++worker.pool->gave_way_;
  }
  worker.gives_way_to->AwaitFreeThread(kGiveWay);
  const auto end = steady_clock::now();
  worker.next = end + (end - begin);
}

WorkerPool::WorkerPool(PoolOptions options)
    : options_(WithThread(std::move(options))),
      running_since_(options_.threads),
      last_finish_(steady_clock::now()) {
  const MutexLock joining(&join_mutex_);
  threads_.reserve(options_.threads);
  for (std::size_t i = 0; i < options_.threads; ++i) threads_.emplace_back([this, i] { Run(i); });
}

WorkerPool::WorkerPool(std::size_t threads, std::size_t queue)
    : WorkerPool(PoolOptions{"pool", threads, queue}) {}

WorkerPool::~WorkerPool() { Stop(); }

bool WorkerPool::TryPost(Job job) { return Post(std::move(job), false, options_.queue); }

bool WorkerPool::Continue(Job job) { return Post(std::move(job), false, kAny); }

bool WorkerPool::PostUrgent(Job job) { return Post(std::move(job), true, kAny); }

bool WorkerPool::Post(Job job, bool urgent, std::size_t room) {
  {
    const MutexLock lock(&mutex_);
    std::deque<Posted>& jobs = urgent ? urgent_ : jobs_;
    if (stopped_ || jobs.size() >= room) return false;
    jobs.push_back({std::move(job), steady_clock::now()});
  }
  wake_.Signal();
  return true;
}

void WorkerPool::Stop() {
  {
    const MutexLock lock(&mutex_);
    stopped_ = true;
  }
  wake_.SignalAll();
  const MutexLock joining(&join_mutex_);
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

std::size_t WorkerPool::waiting() const {
  const MutexLock lock(&mutex_);
  return urgent_.size() + jobs_.size();
}

PoolStats WorkerPool::stats() const {
  const MutexLock lock(&mutex_);
  const Time now = steady_clock::now();
  PoolStats stats;
  stats.waiting = urgent_.size() + jobs_.size();
  stats.running = running_;
  stats.completed = completed_;
  stats.gave_way = gave_way_;
  stats.busy = busy_;
  for (const std::optional<Time>& since : running_since_) {
    if (!since) continue;
    stats.busy += now - *since;
    stats.oldest_running =
        std::max<std::chrono::duration<double>>(stats.oldest_running, now - *since);
  }
  for (const std::deque<Posted>* jobs : {&urgent_, &jobs_}) {
    if (jobs->empty()) continue;
    stats.oldest_waiting =
        std::max<std::chrono::duration<double>>(stats.oldest_waiting, now - jobs->front().since);
  }
  stats.since_finish = now - last_finish_;
  return stats;
}

bool WorkerPool::HasFreeThread() const {
  return running_ < options_.threads && urgent_.empty() && jobs_.empty();
}

bool WorkerPool::AwaitFreeThread(std::chrono::milliseconds patience) const {
  const auto deadline = steady_clock::now() + patience;
  const MutexLock lock(&mutex_);
  while (!HasFreeThread()) {
    if (free_.WaitUntil(&mutex_, deadline)) return HasFreeThread();
  }
  return true;
}

std::optional<WorkerPool::Posted> WorkerPool::Take(std::size_t thread) {
  const MutexLock lock(&mutex_);
  while (urgent_.empty() && jobs_.empty()) {
    if (stopped_) return std::nullopt;
    wake_.Wait(&mutex_);
  }
  std::deque<Posted>& jobs = urgent_.empty() ? jobs_ : urgent_;
  Posted next = std::move(jobs.front());
  jobs.pop_front();
  running_since_[thread] = steady_clock::now();
  ++running_;
  // Nobody else may end and say so.
  if (HasFreeThread()) free_.SignalAll();
  return next;
}

void WorkerPool::Finished(std::size_t thread) {
  {
    const MutexLock lock(&mutex_);
    last_finish_ = steady_clock::now();
    busy_ += last_finish_ - *std::exchange(running_since_[thread], std::nullopt);
    --running_;
    ++completed_;
    if (!HasFreeThread()) return;
  }
  free_.SignalAll();
}

void WorkerPool::Run(std::size_t thread) {
  NameThread(options_.name);
  this_worker = {this, options_.gives_way_to, {}};
  while (std::optional<Posted> next = Take(thread)) {
    if (options_.metrics != nullptr) {
      const std::chrono::duration<double> waited = steady_clock::now() - next->since;
      options_.metrics->Queue(options_.name, waited.count());
    }
    next->job();
    // What the job holds goes before it counts as done.
    next.reset();
    Finished(thread);
  }
}

}  // namespace arap::runtime
