#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/runtime/metrics.h"

namespace arap::runtime {
namespace {

using std::chrono::steady_clock;

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

PoolOptions WithThread(PoolOptions options) {
  options.threads = std::max<std::size_t>(options.threads, 1);
  return options;
}

// Linux has a niceness per thread. That it cannot be set keeps nothing from working.
void DressThread(const PoolOptions& options) {
  constexpr std::size_t kLongestName = 15;
  pthread_setname_np(pthread_self(), options.name.substr(0, kLongestName).c_str());
  if (options.niceness != 0) {
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), options.niceness);
  }
}

}  // namespace

WorkerPool::WorkerPool(PoolOptions options)
    : options_(WithThread(std::move(options))),
      running_since_(options_.threads),
      last_finish_(steady_clock::now()) {
  threads_.reserve(options_.threads);
  for (std::size_t i = 0; i < options_.threads; ++i) threads_.emplace_back([this, i] { Run(i); });
}

WorkerPool::WorkerPool(std::size_t threads, std::size_t queue)
    : WorkerPool(PoolOptions{"pool", threads, queue, 0, nullptr}) {}

WorkerPool::~WorkerPool() { Stop(); }

bool WorkerPool::TryPost(Job job) { return Post(jobs_, std::move(job), options_.queue); }

bool WorkerPool::Continue(Job job) { return Post(jobs_, std::move(job), kAny); }

bool WorkerPool::PostUrgent(Job job) { return Post(urgent_, std::move(job), kAny); }

bool WorkerPool::Post(std::deque<Posted>& jobs, Job job, std::size_t room) {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_ || jobs.size() >= room) return false;
    jobs.push_back({std::move(job), steady_clock::now()});
  }
  wake_.notify_one();
  return true;
}

WorkerPool::Posted WorkerPool::TakeLocked() {
  std::deque<Posted>& jobs = urgent_.empty() ? jobs_ : urgent_;
  Posted next = std::move(jobs.front());
  jobs.pop_front();
  return next;
}

void WorkerPool::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  wake_.notify_all();
  const std::lock_guard joining(join_mutex_);
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

std::size_t WorkerPool::waiting() const {
  const std::lock_guard lock(mutex_);
  return urgent_.size() + jobs_.size();
}

PoolStats WorkerPool::stats() const {
  const std::lock_guard lock(mutex_);
  const Time now = steady_clock::now();
  PoolStats stats;
  stats.waiting = urgent_.size() + jobs_.size();
  stats.completed = completed_;
  stats.busy = busy_;
  for (const std::optional<Time>& since : running_since_) {
    if (!since) continue;
    ++stats.running;
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

void WorkerPool::Run(std::size_t thread) {
  DressThread(options_);
  for (;;) {
    Posted next;
    Time started;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [this] { return stopped_ || !urgent_.empty() || !jobs_.empty(); });
      if (urgent_.empty() && jobs_.empty()) return;
      next = TakeLocked();
      started = steady_clock::now();
      running_since_[thread] = started;
    }
    if (options_.metrics != nullptr) {
      options_.metrics->Queue(options_.name,
                              std::chrono::duration<double>(started - next.since).count());
    }
    next.job();
    // What the job holds goes before it counts as done.
    next.job = nullptr;
    const std::lock_guard lock(mutex_);
    running_since_[thread].reset();
    ++completed_;
    last_finish_ = steady_clock::now();
    busy_ += last_finish_ - started;
  }
}

}  // namespace arap::runtime
