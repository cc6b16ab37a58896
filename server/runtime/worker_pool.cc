#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <utility>

#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/runtime/metrics.h"

namespace arap::runtime {
namespace {

using std::chrono::steady_clock;

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

bool WorkerPool::TryPost(Job job) { return Post(std::move(job), true); }

bool WorkerPool::Continue(Job job) { return Post(std::move(job), false); }

bool WorkerPool::Post(Job job, bool bounded) {
  {
    const std::lock_guard lock(mutex_);
    if (stopped_ || (bounded && jobs_.size() >= options_.queue)) return false;
    jobs_.push_back({std::move(job), steady_clock::now()});
  }
  wake_.notify_one();
  return true;
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
  return jobs_.size();
}

PoolStats WorkerPool::stats() const {
  const std::lock_guard lock(mutex_);
  const Time now = steady_clock::now();
  PoolStats stats;
  stats.waiting = jobs_.size();
  stats.completed = completed_;
  stats.busy = busy_;
  for (const std::optional<Time>& since : running_since_) {
    if (!since) continue;
    ++stats.running;
    stats.busy += now - *since;
    stats.oldest_running =
        std::max<std::chrono::duration<double>>(stats.oldest_running, now - *since);
  }
  if (!jobs_.empty()) stats.oldest_waiting = now - jobs_.front().since;
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
      wake_.wait(lock, [this] { return stopped_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      next = std::move(jobs_.front());
      jobs_.pop_front();
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
