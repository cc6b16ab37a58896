#include "server/streams/admission.h"

#include <set>
#include <string_view>

#include <fmt/format.h>

#include "core/base/names.h"

namespace arap::app {

void Admission::DropSleepersLocked(Time now) {
  std::erase_if(awake_, [now](const auto& each) { return now - each.second.last >= kAwake; });
}

Status Admission::FitsLocked(const std::string& owner, double share) const {
  if (capacity_ <= 0) return {};
  double all = 0;
  double own = 0;
  bool only = true;
  std::set<std::string_view> payers{PayerOf(owner)};
  for (const auto& [stream, awake] : awake_) {
    all += awake.share;
    payers.insert(PayerOf(awake.owner));
    if (PayerOf(awake.owner) != PayerOf(owner)) continue;
    own += awake.share;
    only = false;
  }
  const double part = capacity_ / static_cast<double>(payers.size());
  const double room = std::max(capacity_ - all, part - own);
  if (only || share <= room) return {};
  const double fits = std::max(room, 0.0) / kFloorFps * 1e3;
  return Fail(
      Fault(FaultKind::kLimitExceeded,
            fmt::format("The streams that are awake are entitled to {:.2f} of the {:.2f} workers "
                        "that max_stream_load gives them, {:.2f} of that is yours; at {:g} frames "
                        "a second a stream fits now whose frames take at most {:.2f} ms, and the "
                        "frames of this one take {:.2f} ms.",
                        all, capacity_, own, kFloorFps, fits, share / kFloorFps * 1e3))
          .Detail("quota", "max_stream_load")
          .Detail("limit", fmt::format("{:.3f}", capacity_))
          .Detail("load", fmt::format("{:.3f}", all))
          .Detail("load_of_owner", fmt::format("{:.3f}", own))
          .Detail("floor_fps", kFloorFps)
          .Detail("fits_frame_ms", fmt::format("{:.3f}", fits)));
}

Status Admission::MayOpen(const std::string& owner, double share, Time now) {
  const MutexLock lock(&mutex_);
  DropSleepersLocked(now);
  return FitsLocked(owner, share);
}

Status Admission::WakeUp(Stream stream, const std::string& owner, double share, Time now) {
  const MutexLock lock(&mutex_);
  DropSleepersLocked(now);
  awake_.erase(stream);
  if (auto fits = FitsLocked(owner, share); !fits) return fits;
  awake_[stream] = {owner, share, now};
  return {};
}

void Admission::StaysAwake(Stream stream, double share, Time now) {
  const MutexLock lock(&mutex_);
  const auto found = awake_.find(stream);
  if (found == awake_.end()) return;
  found->second.share = share;
  found->second.last = now;
}

void Admission::Leave(Stream stream) {
  const MutexLock lock(&mutex_);
  awake_.erase(stream);
}

double Admission::Entitled(Time now) {
  const MutexLock lock(&mutex_);
  DropSleepersLocked(now);
  double all = 0;
  for (const auto& [stream, awake] : awake_) all += awake.share;
  return all;
}

}  // namespace arap::app
