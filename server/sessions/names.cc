#include "server/sessions/names.h"

#include <fmt/format.h>

namespace arap::app {

Fault NotFound(std::string_view what, std::string_view name) {
  Fault fault(FaultKind::kNotFound, fmt::format("There is no {} {}.", what, Quote(name)));
  fault.Detail("resource", std::string(what)).Detail("id", std::string(name));
  return fault;
}

Fault Taken(const char* what, const std::string& id, const char* by) {
  Fault fault(FaultKind::kAlreadyExists,
              fmt::format("The {} id {} is in use with {}.", what, Quote(id), by));
  return fault.Detail("resource", what).Detail("id", id);
}

Fault QuotaFull(std::string_view quota, std::size_t limit) {
  Fault fault(FaultKind::kLimitExceeded,
              fmt::format("The quota {} of {} is used up.", quota, limit));
  fault.Detail("quota", std::string(quota)).Detail("limit", std::to_string(limit));
  return fault;
}

Fault TooLarge(std::string_view what, std::string_view quota, std::size_t count,
               std::size_t limit) {
  Fault fault = Fault(FaultKind::kLimitExceeded, fmt::format("{} has {} bytes, more than {} of {}.",
                                                             what, count, quota, limit))
                    .Field("request");
  fault.Detail("count", std::to_string(count)).Detail("quota", std::string(quota));
  return fault.Detail("limit", std::to_string(limit));
}

Fault Overloaded() {
  return Fault(FaultKind::kOverloaded, "All workers are busy and the queue is full.");
}

}  // namespace arap::app
