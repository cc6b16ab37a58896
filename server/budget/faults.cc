#include "server/budget/faults.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "core/base/names.h"

namespace arap::app {

Fault NotFound(std::string_view what, std::string_view id) {
  return Fault(FaultKind::kNotFound, fmt::format("There is no {} {}.", what, Quote(id)))
      .Detail("resource", std::string(what))
      .Detail("id", std::string(id));
}

Fault Taken(std::string_view what, std::string_view id, std::string_view by) {
  return Fault(FaultKind::kAlreadyExists,
               fmt::format("The {} id {} is in use with {}.", what, Quote(id), by))
      .Detail("resource", std::string(what))
      .Detail("id", std::string(id));
}

Fault QuotaFull(std::string_view quota, std::size_t limit) {
  return Fault(FaultKind::kLimitExceeded,
               fmt::format("The quota {} of {} is used up.", quota, limit))
      .Detail("quota", std::string(quota))
      .Detail("limit", limit);
}

Fault TooLarge(std::string_view what, std::string_view quota, std::size_t count,
               std::size_t limit) {
  return Fault(FaultKind::kLimitExceeded,
               fmt::format("{} has {} bytes, more than {} of {}.", what, count, quota, limit))
      .Field("request")
      .Detail("count", count)
      .Detail("quota", std::string(quota))
      .Detail("limit", limit);
}

Fault Overloaded() {
  return Fault(FaultKind::kOverloaded, "All workers are busy and the queue is full.");
}

Fault WithOutlook(Fault fault, std::size_t place, std::chrono::duration<double> wait) {
  constexpr double kLeast = 50;
  constexpr double kMost = 60'000;
  const double millis = std::clamp(wait.count() * 1e3, kLeast, kMost);
  return std::move(fault.Detail("place", place)
                       .Detail("expected_wait_ms", fmt::format("{:.0f}", wait.count() * 1e3))
                       .Detail(std::string(kRetryDelayDetail), fmt::format("{:.0f}", millis)));
}

Fault ForEver(Fault fault) { return std::move(fault.Detail(std::string(kRetryDelayDetail), "0")); }

}  // namespace arap::app
