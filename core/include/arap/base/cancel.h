// CancelToken: how a caller's cancellation or deadline reaches a long computation.
#pragma once

#include <functional>
#include <utility>

#include "arap/base/result.h"

namespace arap {

// Asked between the phases of a long job; a fault (kCancelled, kDeadlineExceeded) ends the job
// there. A default token never cancels. Copyable; the function must be safe to call from the job's
// thread.
class CancelToken {
 public:
  CancelToken() = default;
  explicit CancelToken(std::function<Status()> check) : check_(std::move(check)) {}
  Status Check() const { return check_ ? check_() : Status{}; }

 private:
  std::function<Status()> check_;
};

}  // namespace arap
