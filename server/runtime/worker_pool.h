// WorkerPool: a fixed number of threads behind a bounded queue.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/mutex.h"

namespace arap::runtime {

class Metrics;
class WorkerPool;

struct PoolOptions {
  std::string name = "pool";  // of the threads and of the queue in the metrics
  std::size_t threads = 1;
  std::size_t queue = 0;               // jobs that may wait beside the ones that run
  Metrics* metrics = nullptr;          // told how long jobs waited; outlives the pool
  WorkerPool* gives_way_to = nullptr;  // see GiveWay; outlives the pool
};

// To be called by long jobs between their steps: while every thread of the pool that theirs gives
// way to is busy, waits for one to be free, kGiveWay at most. A job that has waited goes on for as
// long as it has waited before it waits again, so it gets on however busy the others are. Returns
// at once in a thread whose pool gives way to none.
void GiveWay();
inline constexpr std::chrono::milliseconds kGiveWay{5};

// What a pool is doing and has done.
struct PoolStats {
  std::size_t waiting = 0;
  std::size_t running = 0;
  std::uint64_t completed = 0;
  std::uint64_t gave_way = 0;                      // how often its jobs have waited in GiveWay
  std::chrono::duration<double> busy{};            // of all threads, running jobs included
  std::chrono::duration<double> oldest_running{};  // how long the longest job runs, 0 for none
  std::chrono::duration<double> oldest_waiting{};  // how long the oldest in the queue waits
  std::chrono::duration<double> since_finish{};    // since a job ended, or since the start
};

// Thread-safe. Jobs start in the order of posting, urgent ones before the others; every accepted
// job runs exactly once, also when the pool is stopped meanwhile. A job must not throw and must not
// wait for another job of its pool.
class WorkerPool {
 public:
  using Job = std::function<void()>;

  // Has one thread at least.
  explicit WorkerPool(PoolOptions options);
  WorkerPool(std::size_t threads, std::size_t queue);
  // Stops.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // False, and the job is dropped, when the queue is full or the pool has stopped.
  [[nodiscard]] bool TryPost(Job job);

  // The next piece of work that was accepted before: not refused for a full queue, so that a track
  // that has begun can end. Who uses it keeps at most one such job waiting. False only after Stop.
  [[nodiscard]] bool Continue(Job job);

  // A job that starts before all that are not urgent and is not refused for a full queue: frames of
  // streams that were let in, which have one job each. False only after Stop.
  [[nodiscard]] bool PostUrgent(Job job);

  // Refuses new jobs, runs the waiting ones, joins the threads. Harmless when repeated. Not to be
  // called from a job.
  void Stop();

  // Waits until a thread has no job and none waits, `patience` at most. True if one is free.
  bool AwaitFreeThread(std::chrono::milliseconds patience) const;

  const std::string& name() const { return options_.name; }
  std::size_t threads() const { return options_.threads; }
  std::size_t waiting() const;
  PoolStats stats() const;

 private:
  friend void GiveWay();
  using Time = std::chrono::steady_clock::time_point;
  struct Posted {
    Job job;
    Time since;
  };

  bool Post(Job job, bool urgent, std::size_t room);
  void Run(std::size_t thread);
  // Waits for work; nothing when there is none and the pool has stopped.
  std::optional<Posted> Take(std::size_t thread);
  void Finished(std::size_t thread);
  bool HasFreeThread() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const PoolOptions options_;
  mutable Mutex mutex_;
  CondVar wake_;
  mutable CondVar free_;
  std::deque<Posted> urgent_ ABSL_GUARDED_BY(mutex_);
  std::deque<Posted> jobs_ ABSL_GUARDED_BY(mutex_);
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  // By thread.
  std::vector<std::optional<Time>> running_since_ ABSL_GUARDED_BY(mutex_);
  std::size_t running_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t completed_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t gave_way_ ABSL_GUARDED_BY(mutex_) = 0;
  // Of the jobs that have ended.
  std::chrono::steady_clock::duration busy_ ABSL_GUARDED_BY(mutex_){};
  Time last_finish_ ABSL_GUARDED_BY(mutex_);

  Mutex join_mutex_;  // one Stop at a time
  std::vector<std::thread> threads_ ABSL_GUARDED_BY(join_mutex_);
};

}  // namespace arap::runtime
