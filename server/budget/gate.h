// Gate: how many jobs of one kind may be under way at once.
#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

#include "arap/base/result.h"
#include "server/budget/faults.h"

namespace arap::app {

// Thread-safe. `quota` outlives the gate, and the gate its passes.
class Gate {
 public:
  Gate(const char* quota, std::size_t limit) : quota_(quota), limit_(limit) {}
  Gate(const Gate&) = delete;
  Gate& operator=(const Gate&) = delete;

  struct Leave {
    void operator()(Gate* gate) const { --gate->inside_; }
  };
  using Pass = std::unique_ptr<Gate, Leave>;

  // A pass for as long as the job is waiting or running. kLimitExceeded with the quota.
  Result<Pass> Enter() {
    if (++inside_ > limit_) {
      --inside_;
      return Fail(QuotaFull(quota_, limit_));
    }
    return Pass(this);
  }
  std::size_t inside() const { return inside_; }

 private:
  const char* const quota_;
  const std::size_t limit_;
  std::atomic<std::size_t> inside_{0};
};

}  // namespace arap::app
