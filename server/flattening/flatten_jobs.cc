#include "server/flattening/flatten_jobs.h"

#include <algorithm>
#include <atomic>
#include <string_view>
#include <vector>

#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/budget/faults.h"
#include "server/runtime/clock.h"

namespace arap::app {
namespace {

// What is expected of a job of which nobody remembers what was expected.
constexpr double kSomeSeconds = 10;
// An estimate is never more than this part of the work.
constexpr double kNearlyDone = 0.98;

JobView Ended(const std::string& id, const store::JobRecord& record) {
  JobView view;
  view.id = id;
  view.fraction = 1;
  if (!record.fault) {
    view.state = JobState::kDone;
    view.result_bytes = record.result_bytes;
  } else {
    view.state =
        record.fault->kind == FaultKind::kCancelled ? JobState::kCancelled : JobState::kFailed;
  }
  return view;
}

bool HasEnded(const store::JobRecord& record) { return record.fault || !record.result.empty(); }

Fault GoingAway() {
  return Fault(FaultKind::kDraining, "The server is going away; the job begins again on the next.");
}

}  // namespace

struct FlattenJobs::Listening {
  Listener listener;
};

// A job that waits or runs. What has no other owner is guarded by the mutex of FlattenJobs.
struct FlattenJobs::Live {
  Caller caller;
  Key key;
  double expected_seconds = 0;
  std::string phase;
  double fraction = 0;
  bool started = false;      // else the lane is busy with others' work
  runtime::WallTimer since;  // the start of the work
  std::vector<std::weak_ptr<Listening>> listeners;
  std::atomic<bool> cancelled = false;
  std::atomic<bool> draining = false;
};

Result<JobView> FlattenJobs::Submit(const Caller& caller, const std::string& session_id,
                                    const std::string& job_id, const std::string& request,
                                    double expected_seconds) {
  CHECK_OK(CheckName(job_id, "job_id"));
  TRY(const auto session, workshop_.sessions.Use(caller.owner, session_id));
  TRY(const std::string hash, Sha256Hex(request));
  if (!session->record()->jobs.contains(job_id)) {
    CHECK_OK(workshop_.sessions.MayStore(caller, {.bytes = request.size()}));
  }
  // The blob first: a record never names what is not there.
  CHECK_OK(workshop_.stores.blobs->Put(hash, request));
  const auto add = [&](store::SessionRecord& record) -> Result<bool> {
    if (const auto found = record.jobs.find(job_id); found != record.jobs.end()) {
      std::optional<Fault>& fault = found->second.fault;
      if (found->second.request != hash) return Fail(Taken("job", job_id, "another request"));
      if (!fault || InfoOf(fault->kind).retry.count() == 0) return false;
      fault.reset();
      return true;
    }
    if (record.jobs.size() >= kMaxJobsPerSession) {
      return Fail(QuotaFull("max_jobs_per_session", kMaxJobsPerSession));
    }
    record.jobs[job_id] = {hash, request.size(), {}, 0, {}};
    return true;
  };
  {
    const MutexLock lock(&mutex_);
    if (draining_) return Fail(GoingAway());
  }
  TRY(const auto record, workshop_.sessions.Change(caller, *session, add));
  TRY(const auto job, FindJob(*record, job_id));
  if (HasEnded(job)) return Ended(job_id, job);
  const MutexLock lock(&mutex_);
  TRY(const auto live, Enqueue(caller, {session->key(), job_id}, expected_seconds));
  return ViewOf(*live);
}

Result<JobView> FlattenJobs::Look(const Caller& caller, const std::string& session_id,
                                  const std::string& job_id, Listener listener,
                                  std::shared_ptr<Listening>* listening) {
  TRY(const auto session, workshop_.sessions.Use(caller.owner, session_id));
  TRY(const auto job, FindJob(*session->record(), job_id));
  if (HasEnded(job)) return Ended(job_id, job);
  const MutexLock lock(&mutex_);
  TRY(const auto live, Enqueue(caller, {session->key(), job_id}, kSomeSeconds));
  if (listening != nullptr) {
    *listening = std::make_shared<Listening>(Listening{std::move(listener)});
    live->listeners.push_back(*listening);
  }
  return ViewOf(*live);
}

Result<JobView> FlattenJobs::Cancel(const Caller& caller, const std::string& session_id,
                                    const std::string& job_id) {
  TRY(const auto session, workshop_.sessions.Use(caller.owner, session_id));
  const auto end = [&](store::SessionRecord& record) -> Result<bool> {
    const auto found = record.jobs.find(job_id);
    if (found == record.jobs.end()) return Fail(NotFound("job", job_id));
    if (HasEnded(found->second)) return false;
    found->second.fault = Fault(FaultKind::kCancelled, "The job was cancelled.");
    return true;
  };
  TRY(const auto record, workshop_.sessions.Change(caller, *session, end));
  Alive live;
  {
    const MutexLock lock(&mutex_);
    if (const auto found = live_.find({session->key(), job_id}); found != live_.end()) {
      live = found->second;
      live->cancelled = true;
      std::erase(queues_[caller.owner], live);
    }
  }
  if (live) Forget(live);
  TRY(const auto job, FindJob(*record, job_id));
  return Ended(job_id, job);
}

Result<JobResult> FlattenJobs::ResultOf(const Caller& caller, const std::string& session_id,
                                        const std::string& job_id, std::size_t most) {
  TRY(const JobView view, Look(caller, session_id, job_id));
  if (!view.ended()) {
    return Fail(Fault(FaultKind::kProtocol, "The job is not done yet.").Field("job_id"));
  }
  TRY(const auto session, workshop_.sessions.Use(caller.owner, session_id));
  TRY(const auto job, FindJob(*session->record(), job_id));
  if (job.fault) return Fail(*job.fault);
  if (job.result_bytes > most) {
    return Fail(TooLarge("The result", "max_response_bytes", job.result_bytes, most));
  }
  JobResult result;
  TRY(result.room, workshop_.derived.Reserve(caller, job.result_bytes));
  TRY(result.bytes, workshop_.stores.blobs->Get(job.result));
  return result;
}

void FlattenJobs::Drain() {
  std::vector<Alive> all;
  {
    const MutexLock lock(&mutex_);
    draining_ = true;
    queues_.clear();
    for (const auto& [key, live] : live_) {
      live->draining = true;
      all.push_back(live);
    }
  }
  for (const Alive& live : all) Tell(live);
}

std::size_t FlattenJobs::waiting() const {
  const MutexLock lock(&mutex_);
  std::size_t waiting = 0;
  for (const auto& [owner, queue] : queues_) waiting += queue.size();
  return waiting;
}

// The job under the key, waiting or running.
Result<FlattenJobs::Alive> FlattenJobs::Enqueue(const Caller& caller, const Key& key,
                                                double expected_seconds) {
  if (const auto found = live_.find(key); found != live_.end()) return found->second;
  if (draining_) return Fail(GoingAway());
  auto live = std::make_shared<Live>();
  live->caller = caller;
  live->key = key;
  live->expected_seconds = expected_seconds;
  live_[key] = live;
  queues_[caller.owner].push_back(live);
  Next();
  return live;
}

// Begins the next job when none runs: of the owner after the last, as they are sorted.
void FlattenJobs::Next() {
  std::erase_if(queues_, [](const auto& queue) { return queue.second.empty(); });
  if (running_ || queues_.empty() || draining_) return;
  auto at = queues_.upper_bound(last_owner_);
  if (at == queues_.end()) at = queues_.begin();
  const Alive live = at->second.front();
  // Not refused for a full queue, since one at most is on the lane. False at the end of the server.
  const runtime::Share share{live->caller.owner, 0, live->expected_seconds};
  if (!lane_.Continue([this, live] { Run(live); }, share)) return;
  last_owner_ = at->first;
  at->second.pop_front();
  running_ = live;
}

JobView FlattenJobs::ViewOf(const Live& live) const {
  JobView view;
  view.id = live.key.second;
  const double passed = live.started ? 1e-6 * live.since.Micros() : 0;
  view.expected_seconds = live.expected_seconds;
  if (running_.get() == &live && !live.started) return view;
  if (running_.get() == &live) {
    view.state = JobState::kRunning;
    view.phase = live.phase;
    const double guess = std::min(kNearlyDone, passed / std::max(live.expected_seconds, 1e-3));
    view.fraction = std::max(live.fraction, guess);
    view.expected_seconds = std::max(0.0, live.expected_seconds - passed);
    return view;
  }
  // Those of the same owner that came before it, and as many of every other.
  const auto own = queues_.find(live.caller.owner);
  if (own == queues_.end()) return view;
  const auto at = std::find_if(own->second.begin(), own->second.end(),
                               [&live](const Alive& other) { return other.get() == &live; });
  const auto before = static_cast<std::size_t>(at - own->second.begin());
  if (running_) view.expected_seconds += ViewOf(*running_).expected_seconds;
  for (const auto& [owner, queue] : queues_) {
    const std::size_t first = owner == own->first ? before : std::min(before + 1, queue.size());
    view.place += first;
    for (std::size_t k = 0; k < first; ++k) view.expected_seconds += queue[k]->expected_seconds;
  }
  return view;
}

void FlattenJobs::Run(const Alive& live) {
  {
    const MutexLock lock(&mutex_);
    live->started = true;
    live->since = {};
  }
  Tell(live);
  if (auto session = workshop_.sessions.Use(live->key.first.owner, live->key.first.id); session) {
    // When the session ends, so does the job.
    const auto listener = (*session)->AddEndListener([weak = std::weak_ptr(live)] {
      if (const auto ended = weak.lock()) ended->cancelled = true;
    });
    // A fault here leaves the job as it was recorded: it begins again when somebody asks for it.
    static_cast<void>(Finish(live, **session));
    (*session)->RemoveEndListener(listener);
  }
  {
    const MutexLock lock(&mutex_);
    running_ = nullptr;
    live_.erase(live->key);
    Next();
  }
  Tell(live);
}

// Does the work and records what came of it.
Status FlattenJobs::Finish(const Alive& live, Session& session) {
  const std::string& id = live->key.second;
  TRY(const auto job, FindJob(*session.record(), id));
  if (HasEnded(job)) return {};
  const CancelToken cancel([&live]() -> Status {
    runtime::GiveWay();
    if (live->draining) return Fail(GoingAway());
    if (live->cancelled) return Fail(FaultKind::kCancelled, "The job was cancelled.");
    return {};
  });
  const auto progress = [this, &live](std::string_view phase, double fraction) {
    bool next = false;
    {
      const MutexLock lock(&mutex_);
      next = live->phase != phase;
      live->phase = phase;
      live->fraction = std::max(live->fraction, fraction);
    }
    if (next) Tell(live);
  };
  TRY(const std::string request, workshop_.stores.blobs->Get(job.request));
  auto result = OrOutOfMemory([&] { return work_(live->caller, request, cancel, progress); });
  if (!result && result.error().kind == FaultKind::kDraining) return Fail(result.error());
  store::JobRecord ended{job.request, job.request_bytes, {}, 0, {}};
  if (result) {
    progress("storing", kNearlyDone);
    TRY(ended.result, Sha256Hex(*result));
    ended.result_bytes = result->size();
    Status room = workshop_.sessions.MayStore(live->caller, {.bytes = result->size()});
    if (room) {
      CHECK_OK(workshop_.stores.blobs->Put(ended.result, *result));
    } else if (room.error().kind == FaultKind::kLimitExceeded) {
      ended = {job.request, job.request_bytes, {}, 0, std::move(room.error())};
    } else {
      return room;
    }
  } else {
    ended.fault = result.error();
  }
  Status recorded = Record(live, session, ended);
  if (recorded || recorded.error().kind != FaultKind::kLimitExceeded) return recorded;
  // Where there is no room for the result there is room for the reason.
  return Record(live, session,
                {job.request, job.request_bytes, {}, 0, std::move(recorded.error())});
}

// Puts what came of a job into its session, unless it has ended meanwhile.
Status FlattenJobs::Record(const Alive& live, Session& session, const store::JobRecord& ended) {
  const auto end = [&](store::SessionRecord& record) -> Result<bool> {
    const auto found = record.jobs.find(live->key.second);
    if (found == record.jobs.end() || HasEnded(found->second)) return false;
    found->second = ended;
    return true;
  };
  CHECK_OK(workshop_.sessions.Change(live->caller, session, end));
  return {};
}

void FlattenJobs::Forget(const Alive& live) {
  {
    const MutexLock lock(&mutex_);
    const auto found = live_.find(live->key);
    if (found != live_.end() && found->second == live && running_ != live) live_.erase(found);
  }
  Tell(live);
}

void FlattenJobs::Tell(const Alive& live) {
  std::vector<std::shared_ptr<Listening>> listening;
  {
    const MutexLock lock(&mutex_);
    std::erase_if(live->listeners, [](const auto& weak) { return weak.expired(); });
    for (const auto& weak : live->listeners) {
      if (auto one = weak.lock()) listening.push_back(std::move(one));
    }
  }
  for (const auto& one : listening) one->listener();
}

}  // namespace arap::app
