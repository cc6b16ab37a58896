#include "server/sessions/names.h"

#include <algorithm>

#include <fmt/format.h>

namespace arap::app {
namespace {

constexpr std::size_t kMaxQuoted = 64;

bool IsNameCharacter(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' ||
         c == '_' || c == '-';
}

}  // namespace

bool IsName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxNameLength &&
         std::all_of(name.begin(), name.end(), IsNameCharacter);
}

Status CheckName(std::string_view name, std::string field) {
  if (IsName(name)) return {};
  return Fail(Fault(FaultKind::kInvalidName,
                    fmt::format("{} is {}, but an id is 1 to {} characters of [A-Za-z0-9._-].",
                                field, Quote(name), kMaxNameLength))
                  .Field(field)
                  .Detail("length", std::to_string(name.size())));
}

std::string Quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text.substr(0, kMaxQuoted)) quoted += c >= ' ' && c <= '~' ? c : '?';
  quoted += text.size() > kMaxQuoted ? "\"..." : "\"";
  return quoted;
}

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
