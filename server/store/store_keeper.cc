#include "server/store/store_keeper.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "core/base/try.h"

namespace arap::store {
namespace {

constexpr std::chrono::seconds kAskEvery{10};

std::optional<Weakness> SkewOf(runtime::Clock::Wall ours, runtime::Clock::Wall of_store) {
  const auto skew = std::chrono::duration_cast<std::chrono::seconds>(ours - of_store);
  if (std::chrono::abs(skew) <= kMaxSkew) return std::nullopt;
  return Weakness{
      "clock_skew",
      fmt::format("The clock of this server is {} s {} that of the store.",
                  std::chrono::abs(skew).count(), skew.count() > 0 ? "ahead of" : "behind"),
      true};
}

}  // namespace

StoreKeeper::StoreKeeper(SpecStore& specs, BlobStore& blobs, const runtime::Clock& clock,
                         bool allow_lossy)
    : specs_(specs), blobs_(blobs), clock_(clock), allow_lossy_(allow_lossy) {}

Result<bool> StoreKeeper::Owns(const StoreFacts& facts) {
  const Status claimed = blobs_.Claim(facts.id);
  if (claimed) return true;
  if (claimed.error().kind == FaultKind::kInvalidOption) return false;
  return Fail(claimed.error());
}

Result<std::vector<Weakness>> StoreKeeper::Ask() {
  TRY(StoreFacts facts, specs_.Facts());
  std::vector<Weakness> weaknesses = std::move(facts.weaknesses);
  for (Weakness& weakness : weaknesses) weakness.grave = weakness.grave && !allow_lossy_;
  TRY(const auto time, specs_.Time());
  if (time) {
    if (auto skew = SkewOf(clock_.WallNow(), *time)) weaknesses.push_back(*std::move(skew));
  }
  TRY(const bool ours, Owns(facts));
  if (!ours) {
    weaknesses.push_back({"foreign_blobs",
                          "The folder of blobs belongs to another store than the one that is used, "
                          "or that store was emptied: no blob is removed.",
                          false});
  }
  return weaknesses;
}

Status StoreKeeper::Look() {
  {
    const MutexLock lock(&mutex_);
    if (asked_ && clock_.SteadyNow() - *asked_ < kAskEvery) return {};
  }
  TRY(auto weaknesses, Ask());
  const MutexLock lock(&mutex_);
  asked_ = clock_.SteadyNow();
  known_ = std::move(weaknesses);
  return {};
}

Result<SweepReport> StoreKeeper::Collect(const SweepRules& rules) {
  TRY(const auto referenced, specs_.ReferencedBlobs());
  // After the names were read: a store that was emptied before that has another id now.
  TRY(const auto facts, specs_.Facts());
  TRY(const bool ours, Owns(facts));
  if (!ours) return SweepReport{};
  SweepRules now = rules;
  {
    const MutexLock lock(&mutex_);
    if (held_since_ && clock_.SteadyNow() - *held_since_ >= kHoldBack) now.share = 1;
  }
  TRY(const SweepReport report, blobs_.Sweep(referenced, now));
  const MutexLock lock(&mutex_);
  held_ = report;
  if (report.held_back == 0) {
    held_since_.reset();
  } else if (!held_since_) {
    held_since_ = clock_.SteadyNow();
  }
  return report;
}

std::vector<Weakness> StoreKeeper::weaknesses() const {
  const MutexLock lock(&mutex_);
  std::vector<Weakness> weaknesses = known_;
  if (held_since_) {
    const auto left =
        std::chrono::ceil<std::chrono::minutes>(kHoldBack - (clock_.SteadyNow() - *held_since_));
    weaknesses.push_back(
        {"mass_removal",
         fmt::format("{} of {} stored meshes are named by no session any more. They are left in "
                     "their places for {} minutes.",
                     held_.held_back, held_.kept, std::max<long>(left.count(), 0)),
         false});
  }
  return weaknesses;
}

}  // namespace arap::store
