// WorkerPool: a fixed number of threads behind a bounded queue.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace arap::runtime {

class Metrics;

struct PoolOptions {
  std::string name = "pool";  // of the threads and of the queue in the metrics
  std::size_t threads = 1;
  std::size_t queue = 0;       // jobs that may wait beside the ones that run
  int niceness = 0;            // of the threads; 10 yields to those with 0
  Metrics* metrics = nullptr;  // told how long jobs waited; outlives the pool
};

// What a pool is doing and has done.
struct PoolStats {
  std::size_t waiting = 0;
  std::size_t running = 0;
  std::uint64_t completed = 0;
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

  const std::string& name() const { return options_.name; }
  std::size_t threads() const { return options_.threads; }
  std::size_t waiting() const;
  PoolStats stats() const;

 private:
  using Time = std::chrono::steady_clock::time_point;
  struct Posted {
    Job job;
    Time since;
  };

  bool Post(std::deque<Posted>& jobs, Job job, std::size_t room);
  Posted TakeLocked();
  void Run(std::size_t thread);

  const PoolOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  // Guarded by mutex_.
  std::deque<Posted> urgent_;
  std::deque<Posted> jobs_;
  bool stopped_ = false;
  std::vector<std::optional<Time>> running_since_;  // by thread
  std::uint64_t completed_ = 0;
  std::chrono::steady_clock::duration busy_{};  // of the jobs that have ended
  Time last_finish_;

  std::mutex join_mutex_;  // one Stop at a time
  std::vector<std::thread> threads_;
};

}  // namespace arap::runtime
