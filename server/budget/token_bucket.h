// TokenBucket: so many a second, after a burst of as many.
#pragma once

#include <algorithm>
#include <chrono>

#include "server/runtime/clock.h"

namespace arap::app {

// Not thread-safe.
class TokenBucket {
 public:
  // A rate of 0 or less grants everything.
  TokenBucket(double rate, runtime::Clock::Steady now)
      : rate_(rate), tokens_(std::max(rate, 1.0)), last_(now) {}

  bool Take(runtime::Clock::Steady now) {
    if (rate_ <= 0) return true;
    tokens_ += rate_ * std::chrono::duration<double>(now - last_).count();
    tokens_ = std::min(tokens_, std::max(rate_, 1.0));
    last_ = now;
    if (tokens_ < 1) return false;
    --tokens_;
    return true;
  }

 private:
  double rate_;
  double tokens_;
  runtime::Clock::Steady last_;
};

}  // namespace arap::app
