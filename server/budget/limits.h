// Limits: the quotas of the server (arap/model/limits.h), and the bounds that are not configured.
#pragma once

#include <chrono>
#include <cstddef>

#include "arap/model/limits.h"

namespace arap::app {

using arap::Limits;
using arap::OwnerLimits;

inline constexpr std::chrono::milliseconds kMinTtl = std::chrono::seconds(1);
inline constexpr std::size_t kMaxLabels = 16;
inline constexpr std::size_t kMaxLabelBytes = 128;
inline constexpr std::size_t kDefaultPageSize = 100;
inline constexpr std::size_t kMaxPageSize = 1'000;

}  // namespace arap::app
