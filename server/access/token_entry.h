// The entries of a token file, from JSON. See token_file.h for the format.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "server/access/token_file.h"

namespace arap::app {

inline constexpr std::size_t kTokenIdDigits = 32;
inline constexpr std::size_t kTokenSaltDigits = 32;
inline constexpr std::size_t kTokenSecretDigits = 64;  // and those of its hash

// Exactly `digits` lower-case hexadecimal digits.
bool IsHex(std::string_view text, std::size_t digits);

// By id. kInvalidOption with the details "file", "entry" and a field such as "[3].owner".
Result<std::map<std::string, TokenFile::Entry, std::less<>>> ParseTokenEntries(
    std::string_view json, const std::string& file, const OwnerLimits& defaults);

}  // namespace arap::app
