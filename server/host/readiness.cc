#include "server/host/readiness.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace arap::host {
namespace {

using Seconds = std::chrono::duration<double>;

}  // namespace

const char* StateName(Verdict::State state) {
  switch (state) {
    case Verdict::State::kReady:
      return "ready";
    case Verdict::State::kDraining:
      return "draining";
    case Verdict::State::kStuck:
      return "stuck";
    case Verdict::State::kStore:
      return "store";
    case Verdict::State::kDeaf:
      return "deaf";
  }
  return "";
}

void Readiness::WatchLane(std::string name, LaneStats stats) {
  lanes_.push_back({std::move(name), std::move(stats)});
}

void Readiness::Probe() {
  if (!probe_) return;
  {
    const MutexLock lock(&mutex_);
    probing_since_ = clock_.SteadyNow();
  }
  const Status answer = probe_();
  const MutexLock lock(&mutex_);
  probing_since_.reset();
  // The kind and not the message, which may name addresses and paths.
  store_fault_ = answer ? "" : fmt::format("The store fails: {}.", FaultName(answer.error().kind));
}

void Readiness::TellDialled(const Status& dialled) {
  const MutexLock lock(&mutex_);
  if (dialled) deaf_since_.reset();
  if (!dialled && !deaf_since_) deaf_since_ = clock_.SteadyNow();
}

bool Readiness::IsDeaf() const {
  const MutexLock lock(&mutex_);
  return deaf_since_ && clock_.SteadyNow() - *deaf_since_ > stuck_after_;
}

void Readiness::AnnounceStop() {
  const MutexLock lock(&mutex_);
  draining_ = true;
}

Verdict Readiness::Check() const {
  {
    const MutexLock lock(&mutex_);
    if (draining_) return {Verdict::State::kDraining, "The server is going away."};
  }
  const Seconds patience = stuck_after_;
  for (const Lane& lane : lanes_) {
    const runtime::PoolStats stats = lane.stats();
    if (stats.oldest_running > patience) {
      return {Verdict::State::kStuck, fmt::format("A job of the {} lane runs for {:.1f} s.",
                                                  lane.name, stats.oldest_running.count())};
    }
    const Seconds stalled = std::min(stats.oldest_waiting, stats.since_finish);
    if (stalled > patience) {
      return {Verdict::State::kStuck,
              fmt::format("{} jobs of the {} lane wait and none has ended for {:.1f} s.",
                          stats.waiting, lane.name, stalled.count())};
    }
  }
  Verdict verdict;
  for (const store::Weakness& weakness :
       weaknesses_ ? weaknesses_() : std::vector<store::Weakness>()) {
    if (weakness.grave) verdict.state = Verdict::State::kStore;
    verdict.why += (verdict.why.empty() ? "" : " ") + weakness.sentence;
  }
  const MutexLock lock(&mutex_);
  if (probing_since_ && clock_.SteadyNow() - *probing_since_ > stuck_after_) {
    return {Verdict::State::kStore, "The store does not answer."};
  }
  if (deaf_since_) return {Verdict::State::kDeaf, "The server lets nobody in."};
  if (!store_fault_.empty()) return {Verdict::State::kStore, store_fault_};
  return verdict;
}

}  // namespace arap::host
