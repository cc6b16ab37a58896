#include "client/cli/load/rate_search.h"

#include <algorithm>
#include <cmath>

namespace arap::cli {

void RateSearch::Tried(bool met) {
  if (!next_) return;
  (met ? met_ : missed_) = *next_;
  if (!missed_) {
    next_ = *met_ < kHighest ? std::optional(std::min(2 * *met_, kHighest)) : std::nullopt;
  } else if (!met_) {
    next_ = *missed_ > kLowest ? std::optional(std::max(*missed_ / 2, kLowest)) : std::nullopt;
  } else {
    const bool close = *missed_ <= *met_ * (1 + resolution_);
    next_ = close ? std::nullopt : std::optional(std::sqrt(*met_ * *missed_));
  }
}

}  // namespace arap::cli
