// WorkerPool: a lane. A fixed number of threads behind a bounded queue, which owners share in equal
// parts of processor time (fair_queue.h).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/base/cpu_timer.h"
#include "core/base/mutex.h"
#include "server/runtime/fair_queue.h"

namespace arap::runtime {

class Metrics;
class WorkerPool;

struct PoolOptions {
  std::string name = "pool";           // of the threads and of the queue in the metrics
  std::size_t threads = 1;             // jobs that run at once
  std::size_t queue = 0;               // jobs that may wait beside them, see TryPost
  Metrics* metrics = nullptr;          // told how long jobs waited; outlives the pool
  WorkerPool* gives_way_to = nullptr;  // see GiveWay and Helpers; outlives the pool
  // A place beside the others, while one of these has a longer job, for jobs that are expected to
  // take at most so long; 0: none. So they wait for one another only.
  double short_seconds = 0;
  // So many long jobs may stand aside at once while others take their turn, see GiveWay.
  std::size_t aside = 0;
  // Jobs wait for something else: owners share the time that passes and not the processor's.
  bool waits = false;
  // So many threads that are none of the pool's may run a job at once, see TryVisit, which is
  // expected to take at most so long.
  std::size_t visitors = 0;
  double visit_seconds = 0;
  // Of the processor, see SetTimeSlice; 0: as whoever makes the pool.
  std::chrono::microseconds turns{0};
};

// To be called by long jobs between their steps.
//   - A job that has run for FairQueue::kSlice stands aside for one whose turn it is, until it is its
//     own turn again. One that has the place of the short ones and is not short gives it up.
//   - While every thread of the pool that theirs gives way to is busy, waits for one to be free,
//     kGiveWay at most. A job that has waited goes on for as long as it has waited before it waits
//     again, so it gets on however busy the others are.
// Returns at once in a thread of no pool.
void GiveWay();
inline constexpr std::chrono::milliseconds kGiveWay{5};

// What a job can be done along with: another one that reads the same memory, for both together take
// less than one after the other.
struct Company {
  const void* reads = nullptr;  // null: the job is done alone
  std::shared_ptr<void> work;   // what the other one needs to know to do it along
};

// For a job with company, before it begins: takes out of the queue the next job that reads the same
// and would go on waiting, because no thread of the pool is free for it, and answers its `work`; null
// when there is none. Whoever gets it does all of that work, which is no job of its own any more: both
// owners are charged half of what the running job takes from now on. Once per job. A long job takes no
// short one along, and one in the place of the short ones takes none: what is short waits for one of
// its kind at most.
std::shared_ptr<void> TakeAlong();

// What a pool is doing and has done.
struct PoolStats {
  std::size_t waiting = 0;
  std::size_t running = 0;
  std::uint64_t completed = 0;           // also those that were taken along
  std::uint64_t taken_along = 0;         // by other jobs, see TakeAlong
  std::uint64_t gave_way = 0;            // how often its jobs have waited in GiveWay
  std::uint64_t helped = 0;              // parts that its threads took, see Helpers
  std::chrono::duration<double> busy{};  // of all threads, running jobs and parts included
  std::chrono::duration<double> oldest_running{};  // how long the longest job runs, 0 for none
  std::chrono::duration<double> oldest_waiting{};  // how long the oldest in the queue waits
  std::chrono::duration<double> since_finish{};    // since a job ended, or since the start
};

// Thread-safe. Every accepted job runs exactly once, unless it is taken along, also when the pool is
// stopped meanwhile. A job must not throw and must not wait for another job of its pool.
class WorkerPool {
  struct Worker;
  struct EndOfVisit {
    void operator()(Worker* worker) const;
  };

 public:
  using Job = std::function<void()>;
  // While it is there, its thread runs a job. It goes in the same thread, and before the pool.
  using Visit = std::unique_ptr<Worker, EndOfVisit>;
  // What a newcomer would find, see FairQueue.
  struct Outlook {
    std::size_t place = 0;
    std::chrono::duration<double> wait{};
  };

  // Has one thread at least.
  explicit WorkerPool(PoolOptions options);
  WorkerPool(std::size_t threads, std::size_t queue);
  // Stops.
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // False, and the job is dropped, when the queue is full or the pool has stopped. The queue is full
  // for an owner when as many wait as it takes, and of these at least an equal part is the owner's.
  [[nodiscard]] bool TryPost(Job job, Share share = {});

  // The next piece of work that was accepted before, a frame of a stream or a track: not refused for
  // a full queue. Who uses it keeps at most one such job waiting. False only after Stop.
  // The job does not run when another one takes its company along.
  [[nodiscard]] bool Continue(Job job, Share share = {}, Company company = {});

  // Leave to run a short job at once in the thread that asks, so that nobody has to be woken for
  // it. It counts as a job in every way, and changes nobody's turn: there is leave only when the job
  // would be the next to be taken, and there is a place for it or its owner has no other running.
  // The places of the workers stay theirs. A thread has no leave right after a visit: what it does
  // then was waiting behind that, and more may be waiting.
  [[nodiscard]] Visit TryVisit(Share share);

  // What another job of this owner would find now.
  Outlook OutlookOf(const std::string& owner) const;

  // Refuses new jobs, runs the waiting ones, joins the threads. Harmless when repeated. Not to be
  // called from a job.
  void Stop();

  // Waits until a thread has no job and none waits, `patience` at most. True if one is free.
  bool AwaitFreeThread(std::chrono::milliseconds patience) const;

  const std::string& name() const { return options_.name; }
  // The most jobs that run at once.
  std::size_t threads() const { return options_.threads + (options_.short_seconds > 0 ? 1 : 0); }
  std::size_t waiting() const;
  PoolStats stats() const;

 private:
  friend void GiveWay();
  friend std::shared_ptr<void> TakeAlong();
  friend class Helpers;
  using Time = std::chrono::steady_clock::time_point;
  enum class Place { kAny, kShort };
  // A job that stands aside in its thread.
  struct Aside {
    CondVar turn;
    bool go = false;
    Place place = Place::kAny;  // that it goes on in
  };
  struct Posted {
    Job job;
    Aside* aside = nullptr;  // instead of a job
    Company company{};
  };
  using Queue = FairQueue<Posted>;
  struct Running {
    Time since;
    double seconds = 0;  // that it is expected to take
    std::string owner;
  };
  // A thread and the job that it runs. Only the thread itself looks at it.
  struct Worker {
    WorkerPool& pool;
    std::size_t thread = 0;
    Place place = Place::kAny;
    Share share{};
    const void* reads = nullptr;   // see Company
    std::optional<Share> along{};  // of the job that was taken along
    double along_paid = 0;         // charged before it was used
    Time since{};                  // the job waited for its first turn
    Time turn{};                   // when its turn began
    CpuTimer processor{};          // since it was last charged
    Time clock{};                  // likewise
    double used = 0;               // seconds
    double paid = 0;               // of these, charged or charged before
    double helped = 0;             // that other threads took since it was last charged
    Time next_giving_way{};
  };
  // What threads without a job may take parts of, at most `most` of them at a time.
  struct Offer;

  bool Post(Posted posted, Share share, bool counted);
  void Run(std::size_t thread);
  // Waits for work; nothing when there is none and the pool has stopped.
  std::optional<Queue::Entry> Take(Worker& worker);
  std::optional<Queue::Entry> NextLocked(Worker& worker) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool HasPlaceLocked() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool HasShortPlaceLocked() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool OwnerRunsLocked(const std::string& owner) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Finished(Worker& worker);
  void EndVisit(Worker& worker);
  // Its job has ended.
  void NoteEndLocked(Worker& worker) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // What the job has taken since this was last asked, and counts it.
  void ChargeLocked(Worker& worker) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void LeaveLocked(Place place) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void TakeTurns(Worker& worker);
  std::shared_ptr<void> TakeAlong(Worker& worker);
  void GiveWayTo(WorkerPool& others, Worker& worker);
  // Takes a part of what is offered; false when there is none.
  bool HelpLocked() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Does in this thread what no other takes, and returns when all parts have ended.
  void RunOffer(Offer& offer);
  // The pool that this thread's gives way to, or nullptr.
  static WorkerPool* OthersHere();
  // Charges the job of this thread with processor time of others.
  static void ChargeHere(double seconds);
  bool HasFreeThread() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  static thread_local Worker* this_worker;

  const PoolOptions options_;
  mutable Mutex mutex_;
  CondVar wake_;
  mutable CondVar free_;
  Queue queue_ ABSL_GUARDED_BY(mutex_);
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  // By thread, then of visitors.
  std::vector<std::optional<Running>> jobs_ ABSL_GUARDED_BY(mutex_);
  std::size_t idle_ ABSL_GUARDED_BY(mutex_) = 0;           // threads without a job
  std::size_t running_ ABSL_GUARDED_BY(mutex_) = 0;        // jobs, those aside left out
  std::size_t running_short_ ABSL_GUARDED_BY(mutex_) = 0;  // of these, in the place of short ones
  std::size_t visitors_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t completed_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t taken_along_ ABSL_GUARDED_BY(mutex_) = 0;
  std::uint64_t gave_way_ ABSL_GUARDED_BY(mutex_) = 0;
  std::vector<Offer*> offers_ ABSL_GUARDED_BY(mutex_);  // on the stacks of their threads
  std::size_t helping_ ABSL_GUARDED_BY(mutex_) = 0;     // threads that are at a part
  std::uint64_t helped_ ABSL_GUARDED_BY(mutex_) = 0;
  // Of the jobs that have ended.
  std::chrono::steady_clock::duration busy_ ABSL_GUARDED_BY(mutex_){};
  Time last_finish_ ABSL_GUARDED_BY(mutex_);

  Mutex join_mutex_;  // one Stop at a time
  std::vector<std::thread> threads_ ABSL_GUARDED_BY(join_mutex_);
};

}  // namespace arap::runtime
