// FlattenJobs: flattenings that go on when their caller has left, and are found again when the
// server was started anew.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/flattener.h"
#include "core/base/mutex.h"
#include "server/access/caller.h"
#include "server/runtime/worker_pool.h"
#include "server/sessions/workshop.h"

namespace arap::app {

// Jobs that one session can have, those that have ended included.
inline constexpr std::size_t kMaxJobsPerSession = 100;

enum class JobState { kWaiting, kRunning, kDone, kFailed, kCancelled };

// How a job stands at one moment.
struct JobView {
  std::string id;
  JobState state = JobState::kWaiting;
  std::string phase;            // while it runs
  double fraction = 0;          // of the work, never falls here; an estimate until it is 1
  std::size_t place = 0;        // how many start before it, while it waits
  double expected_seconds = 0;  // until it ends
  std::size_t result_bytes = 0;

  bool ended() const { return state != JobState::kWaiting && state != JobState::kRunning; }
};

// What a job has made, and the memory that it takes while it is here.
struct JobResult {
  DerivedCache::Reservation room;
  std::string bytes;
};

// Thread-safe. A job is recorded in its session, its request and result are blobs; what is known
// here alone is who waits and how far it has come. One job runs at a time, so that the other
// threads of the lane are free for short work; owners take turns, the jobs of one go in their
// order. A job that neither has ended nor is known here, because a server ended before it, begins
// again when somebody asks for it. Everything but Drain may wait for the store. All calls answer
// its faults, and kNotFound for a session or job that is not there.
class FlattenJobs {
 public:
  // Makes the result of a request, on the lane. Both are bytes of which only the caller knows the
  // meaning.
  using Work = std::function<Result<std::string>(const Caller& caller, const std::string& request,
                                                 const CancelToken& cancel,
                                                 const FlattenProgress& progress)>;
  using Listener = std::function<void()>;

  // Both outlive it; jobs run on `lane`.
  FlattenJobs(Workshop& workshop, runtime::WorkerPool& lane) : workshop_(workshop), lane_(lane) {}

  // Before the first job.
  void Do(Work work) { work_ = std::move(work); }

  // Records the job and lets it wait its turn. With the same request under the id, answers how that
  // job stands; one that failed for lack of room begins again. Faults: kInvalidName,
  // kAlreadyExists, kLimitExceeded (of what the caller may store, too), kDraining.
  Result<JobView> Submit(const Caller& caller, const std::string& session_id,
                         const std::string& job_id, const std::string& request,
                         double expected_seconds);

  // How it stands. `listener`, when there is one, is called whenever that changes, until its
  // Listening goes; from any thread, without a lock; it returns at once.
  struct Listening;
  Result<JobView> Look(const Caller& caller, const std::string& session_id,
                       const std::string& job_id, Listener listener = {},
                       std::shared_ptr<Listening>* listening = nullptr);

  // Ends it without a result, unless it has ended.
  Result<JobView> Cancel(const Caller& caller, const std::string& session_id,
                         const std::string& job_id);

  // The result. Faults: that of the job, kCancelled; kProtocol while it has not ended;
  // kLimitExceeded when it is larger than `most`, or when there is no room for it.
  Result<JobResult> ResultOf(const Caller& caller, const std::string& session_id,
                             const std::string& job_id, std::size_t most);

  // The running job ends soon, no other begins; their sessions keep them for the next server.
  void Drain();

  std::size_t waiting() const;

 private:
  using Key = std::pair<store::SessionKey, std::string>;
  struct Live;
  using Alive = std::shared_ptr<Live>;

  // These need mutex_.
  Result<Alive> Enqueue(const Caller& caller, const Key& key, double expected_seconds)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Next() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  JobView ViewOf(const Live& live) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  void Run(const Alive& live);
  Status Finish(const Alive& live, Session& session);
  Status Record(const Alive& live, Session& session, const store::JobRecord& ended);
  void Forget(const Alive& live);
  void Tell(const Alive& live);

  Workshop& workshop_;
  runtime::WorkerPool& lane_;
  Work work_;
  mutable Mutex mutex_;
  bool draining_ ABSL_GUARDED_BY(mutex_) = false;
  std::map<Key, Alive> live_ ABSL_GUARDED_BY(mutex_);
  // By owner; the next turn is that of the first owner after last_owner_.
  std::map<std::string, std::deque<Alive>> queues_ ABSL_GUARDED_BY(mutex_);
  std::string last_owner_ ABSL_GUARDED_BY(mutex_);
  Alive running_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::app
