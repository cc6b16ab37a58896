// WorkerPool: a fixed number of threads behind a bounded queue.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace arap::runtime {

// Thread-safe. Jobs start in the order of posting; every accepted job runs exactly once, also when
// the pool is stopped meanwhile. A job must not throw and must not wait for another job of its
// pool.
class WorkerPool {
 public:
  using Job = std::function<void()>;

  // `queue` jobs may wait beside the ones that run.
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

  // Refuses new jobs, runs the waiting ones, joins the threads. Harmless when repeated. Not to be
  // called from a job.
  void Stop();

  std::size_t threads() const { return thread_count_; }
  std::size_t waiting() const;

 private:
  void Run();

  const std::size_t thread_count_;
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Job> jobs_;   // guarded by mutex_
  bool stopped_ = false;   // guarded by mutex_
  std::mutex join_mutex_;  // one Stop at a time
  std::vector<std::thread> threads_;
};

}  // namespace arap::runtime
