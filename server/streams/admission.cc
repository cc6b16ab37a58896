#include "server/streams/admission.h"

#include <algorithm>

#include <fmt/format.h>

namespace arap::app {
namespace {

// Samples closer than this say nothing.
constexpr std::chrono::milliseconds kApart{50};
// Below it the lane counts as idle.
constexpr double kIdle = 0.05;

// Of one frame, measured with script/bench (docs/operations.md), rounded up.
constexpr double kFrameSeconds = 5e-5;
constexpr double kVertexSeconds = 1.5e-7;

}  // namespace

void LoadGuard::Measure(Seconds busy, Time now) {
  if (samples_.empty() || now - samples_.back().time >= kApart) samples_.push_back({now, busy});
  // The last sample that is old enough stays: what has happened since is measured.
  while (samples_.size() > 2 && now - samples_[1].time >= kWindow) samples_.pop_front();
  const double passed = Seconds(now - samples_.front().time).count();
  const double worked = (busy - samples_.front().busy).count();
  measured_ = passed > 0 ? std::clamp(worked / (passed * workers_), 0.0, 1.0) : 0;
}

void LoadGuard::Look(Seconds busy, Time now) {
  const MutexLock lock(&mutex_);
  Measure(busy, now);
}

Status LoadGuard::Admit(double share, Seconds busy, Time now) {
  const MutexLock lock(&mutex_);
  Measure(busy, now);
  while (!newcomers_.empty() && now - newcomers_.front().time >= kWindow) newcomers_.pop_front();
  double load = measured_;
  for (const Newcomer& one : newcomers_) load += one.share / workers_;
  const double wanted = load + share / workers_;
  if (limit_ > 0 && wanted > limit_ && load > kIdle) {
    Fault fault(FaultKind::kLimitExceeded,
                fmt::format("The frames of the open streams take {:.0f} % of the workers' time; "
                            "this one would bring it above max_stream_load of {:.0f} %.",
                            100 * load, 100 * limit_));
    fault.Detail("quota", "max_stream_load").Detail("limit", limit_);
    return Fail(fault.Detail("load", fmt::format("{:.3f}", load)));
  }
  newcomers_.push_back({now, share});
  return {};
}

double LoadGuard::Measured() const {
  const MutexLock lock(&mutex_);
  return measured_;
}

double FrameSeconds(std::size_t vertices, std::size_t refine) {
  return kFrameSeconds +
         kVertexSeconds * static_cast<double>(vertices) * static_cast<double>(1 + refine);
}

}  // namespace arap::app
