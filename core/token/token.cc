#include "core/token/token.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <ctime>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/files.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"

namespace arap {
namespace {

constexpr std::string_view kPrefix = "arapd_";

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

// Where we are in the file, for faults.
struct Place {
  const std::string& file;
  std::size_t entry;

  Fault Bad(const std::string& field, std::string_view what) const {
    return Fault(FaultKind::kInvalidOption,
                 fmt::format("Token file {}, entry {}: {} {}.", file, entry, field, what))
        .Field(fmt::format("[{}].{}", entry, field))
        .Detail("file", file)
        .Detail("entry", entry);
  }
};

// A name out of the file, for messages.
std::string Shown(const std::string& name) { return IsName(name) ? name : Quote(name); }

// The text of a field, empty when it is missing or no text.
std::string Text(const Json& object, const char* field) {
  const auto found = object.find(field);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

bool ParseNumber(std::string_view text, std::size_t at, std::size_t digits, int& value) {
  const char* const end = text.data() + at + digits;
  const auto parsed = std::from_chars(text.data() + at, end, value);
  return parsed.ec == std::errc() && parsed.ptr == end && value >= 0;
}

std::optional<std::chrono::sys_seconds> ParseExpiry(std::string_view text) {
  namespace chrono = std::chrono;
  constexpr std::string_view kForm = "0000-00-00T00:00:00Z";
  if (text.size() != kForm.size()) return std::nullopt;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    if (kForm[i] != '0' && text[i] != kForm[i]) return std::nullopt;
  }
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  if (!ParseNumber(text, 0, 4, year) || !ParseNumber(text, 5, 2, month) ||
      !ParseNumber(text, 8, 2, day) || !ParseNumber(text, 11, 2, hour) ||
      !ParseNumber(text, 14, 2, minute) || !ParseNumber(text, 17, 2, second)) {
    return std::nullopt;
  }
  const chrono::year_month_day date{chrono::year(year), chrono::month(static_cast<unsigned>(month)),
                                    chrono::day(static_cast<unsigned>(day))};
  if (!date.ok() || hour > 23 || minute > 59 || second > 59) return std::nullopt;
  return chrono::sys_days(date) + chrono::hours(hour) + chrono::minutes(minute) +
         chrono::seconds(second);
}

// A field that nobody knows is a slip, and a slip in "expires" or "limits" would let in too much.
Status CheckFields(const Json& object, const Place& place) {
  constexpr std::array<std::string_view, 8> kFields{"id",     "owner",   "role",   "salt",
                                                    "sha256", "expires", "limits", "user_limits"};
  for (const auto& [name, value] : object.items()) {
    if (std::find(kFields.begin(), kFields.end(), name) == kFields.end()) {
      return Fail(place.Bad(Shown(name), "is no field of a token"));
    }
  }
  return {};
}

bool IsTokenLimit(std::string_view name) {
  return std::any_of(std::begin(kLimits), std::end(kLimits), [name](const LimitInfo& info) {
    return !name.empty() && TokenName(info) == name;
  });
}

Result<std::map<std::string, std::uint64_t>> ParseLimits(const Json& object, const char* of,
                                                         const Place& place) {
  if (!object.is_object()) return Fail(place.Bad(of, "is not an object"));
  std::map<std::string, std::uint64_t> limits;
  for (const auto& [name, value] : object.items()) {
    const std::string field = fmt::format("{}.{}", of, Shown(name));
    if (!IsTokenLimit(name)) {
      return Fail(place.Bad(field, "is no limit of an owner"));
    }
    if (!value.is_number_unsigned()) return Fail(place.Bad(field, "is not a whole number"));
    limits[name] = value.get<std::uint64_t>();
  }
  return limits;
}

Result<TokenEntry> ParseEntry(const Json& object, const Place& place) {
  if (!object.is_object()) return Fail(place.Bad("it", "is not an object"));
  CHECK_OK(CheckFields(object, place));
  TokenEntry entry;
  entry.id = Text(object, "id");
  if (!IsHex(entry.id, kTokenIdDigits)) {
    return Fail(place.Bad("id", "is not 32 lower-case hexadecimal digits"));
  }
  entry.owner = Text(object, "owner");
  if (!IsName(entry.owner)) {
    return Fail(place.Bad("owner", "is not a name: " + std::string(kNameRule)));
  }
  if (entry.owner == kNobody) {
    return Fail(place.Bad("owner", "is the name of those who give no identity"));
  }
  const auto role = TokenRoleOf(Text(object, "role"));
  if (!role) return Fail(place.Bad("role", "is neither \"user\" nor \"admin\" nor \"gateway\""));
  entry.role = *role;
  entry.salt = Text(object, "salt");
  if (!IsHex(entry.salt, kTokenSaltDigits)) {
    return Fail(place.Bad("salt", "is not 32 lower-case hexadecimal digits"));
  }
  entry.sha256 = Text(object, "sha256");
  if (!IsHex(entry.sha256, kTokenSecretDigits)) {
    return Fail(place.Bad("sha256", "is not 64 lower-case hexadecimal digits"));
  }
  if (object.contains("expires")) {
    entry.expires = ParseExpiry(Text(object, "expires"));
    if (!entry.expires) {
      return Fail(place.Bad("expires", "is not a time such as \"2027-01-31T00:00:00Z\""));
    }
  }
  if (object.contains("limits")) {
    TRY(entry.limits, ParseLimits(object["limits"], "limits", place));
  }
  if (object.contains("user_limits")) {
    if (entry.role != TokenRole::kGateway) {
      return Fail(place.Bad("user_limits", "is for gateways only"));
    }
    TRY(entry.user_limits, ParseLimits(object["user_limits"], "user_limits", place));
  }
  return entry;
}

OrderedJson ToJson(const TokenEntry& entry) {
  OrderedJson json{{"id", entry.id},
                   {"owner", entry.owner},
                   {"role", NameOf(entry.role)},
                   {"salt", entry.salt},
                   {"sha256", entry.sha256}};
  if (entry.expires) json["expires"] = FormatExpiry(*entry.expires);
  if (!entry.limits.empty()) json["limits"] = entry.limits;
  if (!entry.user_limits.empty()) json["user_limits"] = entry.user_limits;
  return json;
}

template <class AnyJson>
Result<AnyJson> ParseArray(std::string_view text, const std::string& name) {
  AnyJson array = AnyJson::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!array.is_array()) {
    return Fail(
        Fault(FaultKind::kInvalidOption, fmt::format("Token file {} is not a JSON array.", name))
            .Detail("file", name));
  }
  return array;
}

// Every entry, or what is wrong with it.
std::vector<Result<TokenEntry>> ParseEntries(const Json& array, const std::string& name) {
  std::vector<Result<TokenEntry>> entries;
  std::set<std::string> ids;
  for (std::size_t i = 0; i < array.size(); ++i) {
    const Place place{name, i};
    Result<TokenEntry>& entry = entries.emplace_back(ParseEntry(array[i], place));
    const bool repeated = !ids.insert(Text(array[i], "id")).second;
    if (entry && repeated) entry = Fail(place.Bad("id", "is that of an entry before it"));
  }
  return entries;
}

}  // namespace

std::optional<TokenParts> SplitToken(std::string_view token) {
  constexpr std::size_t kSecretAt = kPrefix.size() + kTokenIdDigits + 1;
  if (token.size() != kSecretAt + kTokenSecretDigits || !token.starts_with(kPrefix) ||
      token[kSecretAt - 1] != '_') {
    return std::nullopt;
  }
  const TokenParts parts{token.substr(kPrefix.size(), kTokenIdDigits), token.substr(kSecretAt)};
  if (!IsHex(parts.id, kTokenIdDigits) || !IsHex(parts.secret, kTokenSecretDigits)) {
    return std::nullopt;
  }
  return parts;
}

Result<std::string> HashSecret(std::string_view salt, std::string_view secret) {
  Sha256 hash;
  hash.Bytes(salt.data(), salt.size());
  hash.Bytes(secret.data(), secret.size());
  return hash.Hex();
}

Result<NewToken> MakeToken() {
  NewToken token;
  TRY(token.id, RandomHex(kTokenIdDigits));
  TRY(token.salt, RandomHex(kTokenSaltDigits));
  TRY(const std::string secret, RandomHex(kTokenSecretDigits));
  TRY(token.sha256, HashSecret(token.salt, secret));
  token.text = std::string(kPrefix) + token.id + "_" + secret;
  return token;
}

std::optional<TokenRole> TokenRoleOf(std::string_view name) {
  const auto* const found = std::find(std::begin(kTokenRoles), std::end(kTokenRoles), name);
  if (found == std::end(kTokenRoles)) return std::nullopt;
  return static_cast<TokenRole>(found - std::begin(kTokenRoles));
}

Result<std::vector<TokenEntry>> ParseTokenFile(std::string_view text, const std::string& name) {
  TRY(const Json array, ParseArray<Json>(text, name));
  std::vector<TokenEntry> entries;
  for (Result<TokenEntry>& entry : ParseEntries(array, name)) {
    TRY(entries.emplace_back(), std::move(entry));
  }
  return entries;
}

Result<std::vector<RawTokenEntry>> ParseRawTokenFile(std::string_view text,
                                                     const std::string& name) {
  TRY(const OrderedJson ordered, ParseArray<OrderedJson>(text, name));
  const Json array(ordered);
  std::vector<Result<TokenEntry>> entries = ParseEntries(array, name);
  std::vector<RawTokenEntry> raw;
  for (std::size_t i = 0; i < array.size(); ++i) {
    raw.push_back(
        {ordered[i].dump(), Text(array[i], "id"), Text(array[i], "owner"), std::move(entries[i])});
  }
  return raw;
}

std::string FormatRawTokenFile(std::span<const RawTokenEntry> entries) {
  OrderedJson json = OrderedJson::array();
  for (const RawTokenEntry& entry : entries) json.push_back(OrderedJson::parse(entry.json));
  return json.dump(2) + "\n";
}

std::string FormatTokenFile(std::span<const TokenEntry> entries) {
  OrderedJson json = OrderedJson::array();
  for (const TokenEntry& entry : entries) json.push_back(ToJson(entry));
  return json.dump(2) + "\n";
}

Status ChangeTokenFile(const std::string& path, const TokenFileChange& change) {
  const auto fault = [&path](const char* what, const std::string& why) {
    return Fail(FaultKind::kInternal, fmt::format("Cannot {} {}: {}.", what, path, why));
  };
  const auto reason = [](int error) { return std::generic_category().message(error); };
  constexpr std::chrono::seconds kPatience{30};
  FileLock lock;
  int error = FileLock::TakeWithin(path + ".lock", kPatience, lock);
  if (error == EWOULDBLOCK) return fault("change", "somebody else is changing it");
  if (error != 0) return fault("lock", reason(error));
  std::optional<std::string> text(std::in_place);
  error = ReadWhole(path, *text);
  if (error == ENOENT) text.reset();
  if (error != 0 && error != ENOENT) return fault("read", reason(error));
  TRY(const std::string fresh, change(text));
  error = ReplaceFile(path, fresh);
  return error == 0 ? Status() : fault("write", reason(error));
}

std::string FormatExpiry(std::chrono::sys_seconds time) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::time_t{time.time_since_epoch().count()}));
}

}  // namespace arap
