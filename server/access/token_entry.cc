#include "server/access/token_entry.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/hex.h"
#include "core/base/names.h"
#include "core/token/token.h"

namespace arap::app {
namespace {

using nlohmann::json;

// Where we are in the file, for faults.
struct Place {
  const std::string& file;
  std::size_t entry;

  Fault Bad(const std::string& field, std::string_view what) const {
    Fault fault = Fault(FaultKind::kInvalidOption,
                        fmt::format("Token file {}, entry {}: {} {}.", file, entry, field, what))
                      .Field(fmt::format("[{}].{}", entry, field));
    return fault.Detail("file", file).Detail("entry", std::to_string(entry));
  }
};

// A name out of the file, for messages.
std::string Shown(const std::string& name) { return IsName(name) ? name : Quote(name); }

// The text of a field, empty when it is missing or no text.
std::string Text(const json& object, const char* field) {
  const auto found = object.find(field);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool Number(std::string_view text, std::size_t at, std::size_t digits, int& value) {
  const char* const end = text.data() + at + digits;
  const auto parsed = std::from_chars(text.data() + at, end, value);
  return parsed.ec == std::errc() && parsed.ptr == end && value >= 0;
}

// "2027-01-31T00:00:00Z".
std::optional<TokenFile::Wall> ParseTime(std::string_view text) {
  namespace chrono = std::chrono;
  constexpr std::string_view kForm = "0000-00-00T00:00:00Z";
  if (text.size() != kForm.size()) return std::nullopt;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    if (kForm[i] != '0' && text[i] != kForm[i]) return std::nullopt;
  }
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  if (!Number(text, 0, 4, year) || !Number(text, 5, 2, month) || !Number(text, 8, 2, day) ||
      !Number(text, 11, 2, hour) || !Number(text, 14, 2, minute) || !Number(text, 17, 2, second)) {
    return std::nullopt;
  }
  const chrono::year_month_day date{chrono::year(year), chrono::month(static_cast<unsigned>(month)),
                                    chrono::day(static_cast<unsigned>(day))};
  if (!date.ok() || hour > 23 || minute > 59 || second > 59) return std::nullopt;
  return chrono::sys_days(date) + chrono::hours(hour) + chrono::minutes(minute) +
         chrono::seconds(second);
}

constexpr std::array<std::pair<const char*, std::size_t OwnerLimits::*>, 5> kLimits{{
    {"max_sessions", &OwnerLimits::max_sessions},
    {"max_meshes", &OwnerLimits::max_meshes},
    {"max_handle_sets", &OwnerLimits::max_handle_sets},
    {"max_bytes", &OwnerLimits::max_bytes},
    {"max_streams", &OwnerLimits::max_streams},
}};

Status ReadLimits(const json& object, const Place& place, OwnerLimits& limits) {
  if (!object.is_object()) return Fail(place.Bad("limits", "is not an object"));
  for (const auto& [name, value] : object.items()) {
    const auto* const known =
        std::find_if(kLimits.begin(), kLimits.end(),
                     [&name = name](const auto& limit) { return limit.first == name; });
    const std::string field = "limits." + Shown(name);
    if (known == kLimits.end()) return Fail(place.Bad(field, "is no limit of an owner"));
    if (!value.is_number_unsigned()) return Fail(place.Bad(field, "is not a whole number"));
    limits.*known->second = value.get<std::size_t>();
  }
  return {};
}

Status ReadFields(const json& object, const Place& place, TokenFile::Entry& entry) {
  entry.caller.owner = Text(object, "owner");
  if (!IsName(entry.caller.owner)) {
    return Fail(place.Bad("owner", "is not a name: 1 to 128 characters of [A-Za-z0-9._-]"));
  }
  if (entry.caller.owner == kNobody) {
    return Fail(place.Bad("owner", "is the name of those who give no identity"));
  }
  const std::string role = Text(object, "role");
  if (role != "user" && role != "admin") {
    return Fail(place.Bad("role", "is neither \"user\" nor \"admin\""));
  }
  entry.caller.role = role == "admin" ? Role::kAdmin : Role::kUser;
  entry.salt = Text(object, "salt");
  if (!IsHex(entry.salt, kTokenSaltDigits)) {
    return Fail(place.Bad("salt", "is not 32 lower-case hexadecimal digits"));
  }
  entry.sha256 = Text(object, "sha256");
  if (!IsHex(entry.sha256, kTokenSecretDigits)) {
    return Fail(place.Bad("sha256", "is not 64 lower-case hexadecimal digits"));
  }
  if (object.contains("expires")) {
    entry.expires = ParseTime(Text(object, "expires"));
    if (!entry.expires) {
      return Fail(place.Bad("expires", "is not a time such as \"2027-01-31T00:00:00Z\""));
    }
  }
  return object.contains("limits") ? ReadLimits(object["limits"], place, entry.caller.limits)
                                   : Status();
}

// A name that nobody knows is a slip, and a slip in "expires" or "limits" would let in too much.
Status CheckFields(const json& object, const Place& place) {
  constexpr std::array<std::string_view, 7> kFields{"id",     "owner",   "role",  "salt",
                                                    "sha256", "expires", "limits"};
  for (const auto& [name, value] : object.items()) {
    if (std::find(kFields.begin(), kFields.end(), name) == kFields.end()) {
      return Fail(place.Bad(Shown(name), "is no field of a token"));
    }
  }
  return {};
}

}  // namespace

Result<std::map<std::string, TokenFile::Entry, std::less<>>> ParseTokenEntries(
    std::string_view text, const std::string& file, const OwnerLimits& defaults) {
  const json array = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!array.is_array()) {
    Fault fault(FaultKind::kInvalidOption, fmt::format("Token file {} is not a JSON array.", file));
    return Fail(fault.Detail("file", file));
  }
  std::map<std::string, TokenFile::Entry, std::less<>> entries;
  for (std::size_t i = 0; i < array.size(); ++i) {
    const json& object = array[i];
    const Place place{file, i};
    if (!object.is_object()) return Fail(place.Bad("it", "is not an object"));
    if (auto known = CheckFields(object, place); !known) return Fail(std::move(known.error()));
    std::string id = Text(object, "id");
    if (!IsHex(id, kTokenIdDigits)) {
      return Fail(place.Bad("id", "is not 32 lower-case hexadecimal digits"));
    }
    TokenFile::Entry entry;
    entry.caller.limits = defaults;
    if (auto read = ReadFields(object, place, entry); !read) return Fail(std::move(read.error()));
    if (!entries.emplace(std::move(id), std::move(entry)).second) {
      return Fail(place.Bad("id", "is that of an entry before it"));
    }
  }
  return entries;
}

}  // namespace arap::app
