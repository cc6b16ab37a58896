#include "server/budget/faults.h"

#include <string>

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

}  // namespace arap::app
