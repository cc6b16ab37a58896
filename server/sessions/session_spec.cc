#include "server/sessions/session_spec.h"

#include <utility>

#include <fmt/format.h>

#include "server/sessions/names.h"

namespace arap::app {
namespace {

Fault BadOption(std::string message, std::string field) {
  return Fault(FaultKind::kInvalidOption, std::move(message)).Field(std::move(field));
}

}  // namespace

Status CheckSpec(const SessionSpec& spec, const Limits& limits) {
  if (auto name = CheckName(spec.id, "session_id"); !name) return name;
  if (spec.ttl < kMinTtl || spec.ttl > limits.max_ttl) {
    const double max_seconds = std::chrono::duration<double>(limits.max_ttl).count();
    Fault fault =
        BadOption(fmt::format("The ttl of {} s is not between 1 s and {} s.",
                              std::chrono::duration<double>(spec.ttl).count(), max_seconds),
                  "ttl");
    return Fail(fault.Detail("limit", fmt::format("{}", max_seconds)).Detail("quota", "max_ttl"));
  }
  if (spec.labels.size() > kMaxLabels) {
    Fault fault =
        BadOption(fmt::format("There are {} labels, more than {}.", spec.labels.size(), kMaxLabels),
                  "labels");
    return Fail(fault.Detail("count", std::to_string(spec.labels.size()))
                    .Detail("limit", std::to_string(kMaxLabels)));
  }
  for (const auto& [key, value] : spec.labels) {
    if (key.empty() || key.size() > kMaxLabelBytes || value.size() > kMaxLabelBytes) {
      Fault fault = BadOption(
          fmt::format("The label {} is empty or longer than {} bytes.", Quote(key), kMaxLabelBytes),
          "labels");
      return Fail(fault.Detail("limit", std::to_string(kMaxLabelBytes)));
    }
  }
  return {};
}

Status CheckPage(std::size_t size, const std::string& token) {
  if (size > kMaxPageSize) {
    Fault fault = BadOption(fmt::format("The page size of {} is more than {}.", size, kMaxPageSize),
                            "page_size");
    return Fail(fault.Detail("limit", std::to_string(kMaxPageSize)));
  }
  if (!token.empty() && !IsName(token)) {
    return Fail(BadOption("The page token was not given by this server.", "page_token"));
  }
  return {};
}

}  // namespace arap::app
