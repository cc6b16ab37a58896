// Names: the rule for the ids that clients choose (sessions, meshes, handle sets, handles) and for
// the owners of tokens, and how a name of a client's is shown in a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap {

inline constexpr std::size_t kMaxNameLength = 128;

// The owner of callers without an identity, on servers that require none. No token can name it.
inline constexpr const char* kNobody = "anonymous";

// 1 to 128 characters of [A-Za-z0-9._-].
bool IsName(std::string_view name);

// kInvalidName with the request field `field` unless IsName.
Status CheckName(std::string_view name, std::string field);

// A client's string for a message: in quotes, cut when long, unprintable bytes replaced.
std::string Quote(std::string_view text);

}  // namespace arap
