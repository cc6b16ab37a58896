// Gate: how many jobs of one kind may be under way at once.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>

#include "arap/base/result.h"
#include "core/base/mutex.h"
#include "core/base/names.h"
#include "server/budget/faults.h"

namespace arap::app {

// Thread-safe. `quota` outlives the gate, and the gate its passes. Owners that are inside have equal
// parts of it when it is full.
class Gate {
 public:
  Gate(const char* quota, std::size_t limit) : quota_(quota), limit_(limit) {}
  Gate(const Gate&) = delete;
  Gate& operator=(const Gate&) = delete;

  // For as long as the job is waiting or running.
  class Pass {
   public:
    Pass() = default;
    Pass(Pass&& other) noexcept { *this = std::move(other); }
    Pass& operator=(Pass&& other) noexcept {
      if (this == &other) return *this;
      reset();
      gate_ = std::exchange(other.gate_, nullptr);
      payer_ = std::move(other.payer_);
      return *this;
    }
    ~Pass() { reset(); }
    void reset() {
      if (Gate* gate = std::exchange(gate_, nullptr)) gate->Leave(payer_);
    }

   private:
    friend class Gate;
    Pass(Gate* gate, std::string payer) : gate_(gate), payer_(std::move(payer)) {}
    Gate* gate_ = nullptr;
    std::string payer_;
  };

  // kLimitExceeded with the quota when as many are inside as may be, and of these at least an equal
  // part is the owner's, or its gateway's.
  Result<Pass> Enter(const std::string& owner) {
    const std::string payer(PayerOf(owner));
    const MutexLock lock(&mutex_);
    const auto found = by_payer_.find(payer);
    const std::size_t own = found == by_payer_.end() ? 0 : found->second;
    const std::size_t payers = by_payer_.size() + (own == 0 ? 1 : 0);
    if (inside_ >= limit_ && own >= limit_ / payers) return Fail(QuotaFull(quota_, limit_));
    ++inside_;
    ++by_payer_[payer];
    return Pass(this, payer);
  }

  std::size_t inside() const {
    const MutexLock lock(&mutex_);
    return inside_;
  }

 private:
  void Leave(const std::string& payer) {
    const MutexLock lock(&mutex_);
    --inside_;
    const auto found = by_payer_.find(payer);
    if (--found->second == 0) by_payer_.erase(found);
  }

  const char* const quota_;
  const std::size_t limit_;
  mutable Mutex mutex_;
  std::size_t inside_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, std::size_t> by_payer_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace arap::app
