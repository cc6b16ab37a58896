// Names in text: the rule for the ids that clients choose (sessions, meshes, handle sets, handles)
// and for the owners of tokens, how a client's name is shown in a message, and the hexadecimal
// digits of ids, salts and digests that machines make.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

inline constexpr std::size_t kMaxNameLength = 128;
// The rule in words, for messages.
inline constexpr std::string_view kNameRule = "1 to 128 characters of [A-Za-z0-9._-]";

// The owner of callers without an identity, on servers that require none. No token can name it.
inline constexpr const char* kNobody = "anonymous";

// Who answers for an owner: of the owner "GATEWAY/NAME" the gateway, else the owner itself. Equal
// parts of what all share are reckoned by it, so that many users do not make a part each.
inline std::string_view PayerOf(std::string_view owner) { return owner.substr(0, owner.find('/')); }

// Whether it is as kNameRule says.
bool IsName(std::string_view name);

// kInvalidName with the request field `field` unless IsName.
Status CheckName(std::string_view name, std::string field);

// A client's string for a message: in quotes, cut when long, unprintable bytes replaced.
std::string Quote(std::string_view text);

// Two digits for each byte, in lower case.
std::string Hex(std::span<const unsigned char> bytes);

// Whether the text is exactly so many digits, in lower case.
bool IsHex(std::string_view text, std::size_t digits);

}  // namespace arap
