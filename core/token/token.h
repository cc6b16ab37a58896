// Bearer tokens and the server's file of them.
//
// A token is the text "arapd_ID_SECRET": 32 lower-case hexadecimal digits that name an entry of the
// token file and 64 that prove it. The file keeps a salted hash of the secret. Secrets are 256
// random bits, so one round of the hash is as good as many.
//
// `arapctl token` writes the file, arapd reads it. It is a JSON array with one object for each
// token:
//
//   {"id": "…32 digits…",
//    "owner": "alice",                      a name (core/base/names.h), but not "anonymous"
//    "role": "user",                        or "admin" or "gateway"
//    "salt": "…32 digits…",
//    "sha256": "…64 digits…",               see HashSecret
//    "expires": "2027-01-31T00:00:00Z",     optional, UTC
//    "limits": {"max_sessions": 10, …},     optional: those with a TokenName
//    "user_limits": {"max_sessions": 1, …}} likewise, of gateways only: for each of its users; the
//                                           "limits" are for the gateway and its users together
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/limits.h"

namespace arap {

inline constexpr std::size_t kTokenIdDigits = 32;
inline constexpr std::size_t kTokenSaltDigits = 32;
inline constexpr std::size_t kTokenSecretDigits = 64;

struct TokenParts {
  std::string_view id;
  std::string_view secret;
};

// The parts of a token, as views of its text; nothing for a text that is no token. Looks at its
// form only.
std::optional<TokenParts> SplitToken(std::string_view token);

// What the file keeps of a secret: SHA-256 of the text of the salt followed by that of the secret,
// 64 digits. kInternal if it cannot be computed.
Result<std::string> HashSecret(std::string_view salt, std::string_view secret);

// A fresh token, and what its entry in the file says of it.
struct NewToken {
  std::string text;  // the token itself: shown once, kept nowhere
  std::string id;
  std::string salt;
  std::string sha256;
};

// Id, salt and secret are random. kInternal when the system has no random numbers.
Result<NewToken> MakeToken();

enum class TokenRole { kUser, kAdmin, kGateway };

// By their numbers, as the file and `arapctl token` spell them.
inline constexpr const char* kTokenRoles[] = {"user", "admin", "gateway"};
inline const char* NameOf(TokenRole role) { return kTokenRoles[static_cast<int>(role)]; }
// Nothing for any other text.
std::optional<TokenRole> TokenRoleOf(std::string_view name);

struct TokenEntry {
  std::string id;
  std::string owner;
  TokenRole role = TokenRole::kUser;
  std::string salt;
  std::string sha256;
  // Seconds, because the clock's nanoseconds end in the year 2262 and the file's years in 9999.
  std::optional<std::chrono::sys_seconds> expires;
  // Of the owner for calls with this token, by name; what is missing is the server's.
  std::map<std::string, std::uint64_t> limits;
  std::map<std::string, std::uint64_t> user_limits;  // of each user of a gateway
};

// The entries of a file's text; `name` is the file's, for messages. kInvalidOption with the file,
// the entry (counted from 0) and the field. Nothing of a salt or a hash is ever in a message. Two
// entries may have one owner, but not one id.
Result<std::vector<TokenEntry>> ParseTokenFile(std::string_view text, const std::string& name);

// The text that ParseTokenFile reads back.
std::string FormatTokenFile(std::span<const TokenEntry> entries);

// An entry as it stands in the file, good or damaged: to list a damaged file and to remove entries
// from it.
struct RawTokenEntry {
  std::string json;
  // The texts of these fields, whatever they are; empty where there is none.
  std::string id;
  std::string owner;
  Result<TokenEntry> entry;  // or the fault for which ParseTokenFile refuses the file
};

// kInvalidOption only for a text that is no JSON array.
Result<std::vector<RawTokenEntry>> ParseRawTokenFile(std::string_view text,
                                                     const std::string& name);

// The file of these entries, each with the fields and values that it was read with.
std::string FormatRawTokenFile(std::span<const RawTokenEntry> entries);

// Changes the file: `change` gets its text, nothing when there is no file, and answers the new one.
// A lock beside the file (PATH.lock) is held from reading to writing, so that changes of several
// processes come one after the other; the new text is on the disk when this returns. Faults: that
// of `change`; kInternal with the path when the file cannot be read or written, or when somebody
// else changes it for longer than half a minute.
using TokenFileChange = std::function<Result<std::string>(const std::optional<std::string>& text)>;
Status ChangeTokenFile(const std::string& path, const TokenFileChange& change);

// "2027-01-31T00:00:00Z", for the years 0 to 9999.
std::string FormatExpiry(std::chrono::sys_seconds time);

}  // namespace arap
