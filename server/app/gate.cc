#include "server/app/gate.h"

#include "server/app/names.h"

namespace arap::app {

Result<Gate::Pass> Gate::Enter() {
  if (++inside_ > limit_) {
    --inside_;
    return Fail(QuotaFull(quota_, limit_));
  }
  return Pass(this);
}

}  // namespace arap::app
