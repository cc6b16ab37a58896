// TokenBucket: how often something may happen, updates of a stream for example.
#pragma once

#include <algorithm>
#include <chrono>

#include "server/runtime/clock.h"

namespace arap::runtime {

// So many a second, after a burst. Not thread-safe.
class TokenBucket {
 public:
  // A burst of as many as come in a second. A rate of 0 or less grants everything.
  TokenBucket(double rate, Clock::Steady now) : TokenBucket(rate, rate, now) {}
  TokenBucket(double rate, double burst, Clock::Steady now)
      : rate_(rate), burst_(std::max(burst, 1.0)), tokens_(burst_), last_(now) {}

  bool Take(Clock::Steady now) {
    if (rate_ <= 0) return true;
    tokens_ += rate_ * std::chrono::duration<double>(now - last_).count();
    tokens_ = std::min(tokens_, burst_);
    last_ = now;
    if (tokens_ < 1) return false;
    --tokens_;
    return true;
  }
  // Whether the burst is there again.
  bool IsFull(Clock::Steady now) const {
    return tokens_ + rate_ * std::chrono::duration<double>(now - last_).count() >= burst_;
  }
  // The burst is there again.
  void Fill() { tokens_ = burst_; }

 private:
  double rate_;
  double burst_;
  double tokens_;
  Clock::Steady last_;
};

}  // namespace arap::runtime
