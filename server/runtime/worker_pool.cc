#include "server/runtime/worker_pool.h"

#include <algorithm>
#include <utility>

#include <pthread.h>

#include "server/runtime/metrics.h"
#include "server/runtime/time_slice.h"

namespace arap::runtime {
namespace {

using std::chrono::steady_clock;

PoolOptions WithThread(PoolOptions options) {
  options.threads = std::max<std::size_t>(options.threads, 1);
  return options;
}

void NameThread(const std::string& name) {
  constexpr std::size_t kLongestName = 15;
  pthread_setname_np(pthread_self(), name.substr(0, kLongestName).c_str());
}

}  // namespace

thread_local WorkerPool::Worker* WorkerPool::this_worker = nullptr;

void GiveWay() {
  WorkerPool::Worker* worker = WorkerPool::this_worker;
  if (worker == nullptr) return;
  WorkerPool& pool = worker->pool;
  pool.TakeTurns(*worker);
  if (pool.options_.gives_way_to != nullptr) {
    pool.GiveWayTo(*pool.options_.gives_way_to, *worker);
  }
}

std::shared_ptr<void> TakeAlong() {
  WorkerPool::Worker* worker = WorkerPool::this_worker;
  return worker == nullptr ? nullptr : worker->pool.TakeAlong(*worker);
}

WorkerPool::WorkerPool(PoolOptions options)
    : options_(WithThread(std::move(options))), last_finish_(steady_clock::now()) {
  const std::size_t all = threads() + options_.aside;
  {
    const MutexLock lock(&mutex_);
    jobs_.resize(all + options_.visitors);
  }
  const MutexLock joining(&join_mutex_);
  threads_.reserve(all);
  for (std::size_t i = 0; i < all; ++i) threads_.emplace_back([this, i] { Run(i); });
}

WorkerPool::WorkerPool(std::size_t threads, std::size_t queue)
    : WorkerPool(PoolOptions{"pool", threads, queue}) {}

WorkerPool::~WorkerPool() { Stop(); }

bool WorkerPool::TryPost(Job job, Share share) {
  return Post({std::move(job)}, std::move(share), true);
}

bool WorkerPool::Continue(Job job, Share share, Company company) {
  return Post({std::move(job), nullptr, std::move(company)}, std::move(share), false);
}

bool WorkerPool::Post(Posted posted, Share share, bool counted) {
  {
    const MutexLock lock(&mutex_);
    if (stopped_ || (counted && !queue_.HasRoom(share.owner, options_.queue))) return false;
    const bool has_place =
        HasPlaceLocked() || (share.seconds <= options_.short_seconds && HasShortPlaceLocked());
    queue_.Push({std::move(share), steady_clock::now(), std::move(posted)}, counted);
    // Else whoever ends next takes it.
    if (!has_place) return true;
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
  return queue_.size();
}

WorkerPool::Outlook WorkerPool::OutlookOf(const std::string& owner) const {
  const MutexLock lock(&mutex_);
  const auto outlook = queue_.OutlookOf(owner);
  return {outlook.place,
          std::chrono::duration<double>(outlook.seconds / static_cast<double>(options_.threads))};
}

PoolStats WorkerPool::stats() const {
  const MutexLock lock(&mutex_);
  const Time now = steady_clock::now();
  PoolStats stats;
  stats.waiting = queue_.size();
  stats.running = running_ + visitors_;
  stats.completed = completed_;
  stats.taken_along = taken_along_;
  stats.gave_way = gave_way_;
  stats.helped = helped_;
  stats.busy = busy_;
  for (const std::optional<Running>& job : jobs_) {
    if (!job) continue;
    stats.busy += now - job->since;
    stats.oldest_running =
        std::max<std::chrono::duration<double>>(stats.oldest_running, now - job->since);
  }
  if (const auto oldest = queue_.oldest()) stats.oldest_waiting = now - *oldest;
  stats.since_finish = now - last_finish_;
  return stats;
}

bool WorkerPool::HasPlaceLocked() const { return running_ - running_short_ < options_.threads; }

bool WorkerPool::HasShortPlaceLocked() const {
  if (options_.short_seconds <= 0 || running_short_ > 0) return false;
  const Time now = steady_clock::now();
  const std::chrono::duration<double> longest(options_.short_seconds);
  return std::any_of(jobs_.begin(), jobs_.end(), [&](const std::optional<Running>& job) {
    return job && (job->seconds > longest.count() || now - job->since > longest);
  });
}

bool WorkerPool::HasFreeThread() const { return HasPlaceLocked() && queue_.empty(); }

bool WorkerPool::AwaitFreeThread(std::chrono::milliseconds patience) const {
  const auto deadline = steady_clock::now() + patience;
  const MutexLock lock(&mutex_);
  while (!HasFreeThread()) {
    if (free_.WaitUntil(&mutex_, deadline)) return HasFreeThread();
  }
  return true;
}

std::optional<WorkerPool::Queue::Entry> WorkerPool::NextLocked(Worker& worker) {
  while (true) {
    std::optional<Queue::Entry> next;
    Place place = Place::kAny;
    if (HasPlaceLocked()) {
      next = queue_.Pop();
    } else if (!queue_.empty() && HasShortPlaceLocked()) {
      place = Place::kShort;
      next = queue_.Pop(options_.short_seconds);
    }
    if (!next) return std::nullopt;
    ++running_;
    if (place == Place::kShort) ++running_short_;
    Aside* aside = next->item.aside;
    if (aside == nullptr) {
      worker.place = place;
      return next;
    }
    // Its own thread goes on with it; this one looks for more.
    aside->place = place;
    aside->go = true;
    aside->turn.Signal();
  }
}

std::optional<WorkerPool::Queue::Entry> WorkerPool::Take(Worker& worker) {
  const MutexLock lock(&mutex_);
  ++idle_;
  std::optional<Queue::Entry> next;
  while (!(next = NextLocked(worker))) {
    if (stopped_ && queue_.empty()) break;
    if (HelpLocked()) continue;
    wake_.Wait(&mutex_);
  }
  --idle_;
  if (!next) return next;
  const Time now = steady_clock::now();
  jobs_[worker.thread] = Running{now, next->share.seconds, next->share.owner};
  worker.share = next->share;
  worker.reads = next->item.company.reads;
  worker.along.reset();
  worker.since = next->since;
  worker.turn = worker.clock = now;
  worker.processor.Lap();
  worker.used = 0;
  worker.paid = Queue::Paid(next->share);
  // Nobody else may end and say so.
  if (HasFreeThread()) free_.SignalAll();
  // This one may be the long job that opens the place of the short ones.
  if (!queue_.empty() && (HasPlaceLocked() || HasShortPlaceLocked())) wake_.Signal();
  return next;
}

void WorkerPool::ChargeLocked(Worker& worker) {
  const Time now = steady_clock::now();
  const std::chrono::duration<double> passed = now - std::exchange(worker.clock, now);
  const double processor = worker.processor.Lap() * 1e-3 + std::exchange(worker.helped, 0);
  const double spent = (options_.waits ? passed.count() : processor) / (worker.along ? 2 : 1);
  worker.used += spent;
  queue_.Charge(worker.share, worker.used - worker.paid);
  worker.paid = worker.used;
  if (worker.along) queue_.Charge(*worker.along, spent - std::exchange(worker.along_paid, 0));
}

WorkerPool* WorkerPool::OthersHere() {
  return this_worker == nullptr ? nullptr : this_worker->pool.options_.gives_way_to;
}

void WorkerPool::ChargeHere(double seconds) { this_worker->helped += seconds; }

void WorkerPool::LeaveLocked(Place place) {
  --running_;
  if (place == Place::kShort) --running_short_;
}

void WorkerPool::NoteEndLocked(Worker& worker) {
  ChargeLocked(worker);
  last_finish_ = worker.clock;
  busy_ += last_finish_ - std::exchange(jobs_[worker.thread], std::nullopt)->since;
  completed_ += worker.along ? 2u : 1u;
}

void WorkerPool::Finished(Worker& worker) {
  {
    const MutexLock lock(&mutex_);
    NoteEndLocked(worker);
    LeaveLocked(worker.place);
    // Those that wait for the last job to end.
    if (stopped_) wake_.SignalAll();
    if (!HasFreeThread()) return;
  }
  free_.SignalAll();
}

void WorkerPool::TakeTurns(Worker& worker) {
  if (options_.aside == 0) return;
  const Time now = steady_clock::now();
  if (now - worker.turn < std::chrono::duration<double>(Queue::kSlice)) return;
  const MutexLock lock(&mutex_);
  ChargeLocked(worker);
  worker.turn = now;
  const bool overdue = worker.place == Place::kShort;
  worker.share.seconds = std::max(worker.share.seconds, worker.used);
  // Somebody has to be there to take the turn; half of the places aside are for the sake of other
  // owners.
  const bool others = idle_ <= options_.aside / 2;
  if (idle_ == 0 || !(overdue || queue_.Precedes(worker.share, worker.since, others))) return;
  LeaveLocked(worker.place);
  busy_ += now - std::exchange(jobs_[worker.thread], std::nullopt)->since;
  Aside aside;
  queue_.Push({worker.share, worker.since, {nullptr, &aside}}, false);
  wake_.Signal();
  while (!aside.go) aside.turn.Wait(&mutex_);
  worker.place = aside.place;
  worker.paid += Queue::Paid(worker.share);
  worker.turn = worker.clock = steady_clock::now();
  jobs_[worker.thread] = Running{worker.turn, worker.share.seconds, worker.share.owner};
}

std::shared_ptr<void> WorkerPool::TakeAlong(Worker& worker) {
  std::optional<Queue::Entry> taken;
  bool wakes = false;
  {
    const MutexLock lock(&mutex_);
    if (worker.reads == nullptr || worker.along || worker.place == Place::kShort ||
        HasPlaceLocked()) {
      return nullptr;
    }
    // Both are answered when both are done, so that short work takes its like only, for which there may be a place of
    // its own, and none takes what is much longer than itself.
    const bool is_short = worker.share.seconds <= options_.short_seconds;
    if (is_short && HasShortPlaceLocked()) return nullptr;
    taken = queue_.PopWhere([&](const Queue::Entry& entry) {
      return entry.item.company.reads == worker.reads &&
             (entry.share.seconds <= options_.short_seconds) == is_short &&
             (is_short || entry.share.seconds <= 2 * worker.share.seconds);
    });
    if (!taken) return nullptr;
    // What it has taken alone; it is charged in the end, for all of it is paid for.
    worker.clock = steady_clock::now();
    worker.used += worker.processor.Lap() * 1e-3 + std::exchange(worker.helped, 0);
    worker.along_paid = Queue::Paid(taken->share);
    ++taken_along_;
    // Both together may be a long job, beside which there is a place for short ones.
    jobs_[worker.thread]->seconds += taken->share.seconds;
    worker.along = std::move(taken->share);
    wakes = !queue_.empty() && HasShortPlaceLocked();
  }
  if (wakes) wake_.Signal();
  if (options_.metrics != nullptr) {
    const std::chrono::duration<double> waited = steady_clock::now() - taken->since;
    options_.metrics->Queue(options_.name, waited.count());
  }
  return std::move(taken->item.company.work);
}

void WorkerPool::GiveWayTo(WorkerPool& others, Worker& worker) {
  const auto begin = steady_clock::now();
  if (begin < worker.next_giving_way) return;
  if (others.AwaitFreeThread(std::chrono::milliseconds::zero())) return;
  {
    const MutexLock lock(&mutex_);
    ++gave_way_;
  }
  others.AwaitFreeThread(kGiveWay);
  const auto end = steady_clock::now();
  worker.next_giving_way = end + (end - begin);
}

void WorkerPool::Run(std::size_t thread) {
  NameThread(options_.name);
  if (options_.turns.count() > 0) SetTimeSlice(options_.turns);
  Worker worker{*this, thread};
  this_worker = &worker;
  while (std::optional<Queue::Entry> next = Take(worker)) {
    if (options_.metrics != nullptr) {
      const std::chrono::duration<double> waited = worker.turn - next->since;
      options_.metrics->Queue(options_.name, waited.count());
    }
    next->item.job();
    // What the job holds goes before it counts as done.
    next.reset();
    Finished(worker);
  }
}

}  // namespace arap::runtime
