#include "server/budget/gate.h"

#include "server/budget/faults.h"

namespace arap::app {

Result<Gate::Pass> Gate::Enter() {
  if (++inside_ > limit_) {
    --inside_;
    return Fail(QuotaFull(quota_, limit_));
  }
  return Pass(this);
}

}  // namespace arap::app
