#include "core/base/names.h"

#include <algorithm>

#include <fmt/format.h>

namespace arap {
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
                    fmt::format("{} is {}, but an id is {}.", field, Quote(name), kNameRule))
                  .Field(field)
                  .Detail("length", name.size()));
}

std::string Quote(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text.substr(0, kMaxQuoted)) quoted += c >= ' ' && c <= '~' ? c : '?';
  quoted += text.size() > kMaxQuoted ? "\"..." : "\"";
  return quoted;
}

std::string Hex(std::span<const unsigned char> bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  hex.reserve(2 * bytes.size());
  for (const unsigned char byte : bytes) {
    hex += kDigits[byte >> 4u];
    hex += kDigits[byte & 15u];
  }
  return hex;
}

bool IsHex(std::string_view text, std::size_t digits) {
  return text.size() == digits && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

}  // namespace arap
