// Names: the ids that clients choose for sessions, meshes, handle sets and handles.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "arap/base/result.h"

namespace arap::app {

inline constexpr std::size_t kMaxNameLength = 128;

// 1 to 128 characters of [A-Za-z0-9._-].
bool IsName(std::string_view name);

// kInvalidName with the request field `field` unless IsName.
Status CheckName(std::string_view name, std::string field);

// A client's string for a message: in quotes, cut when long, unprintable bytes replaced.
std::string Quote(std::string_view text);

// kNotFound for a session, a mesh or a handle set: NotFound("mesh", "face").
Fault NotFound(std::string_view what, std::string_view name);

// kAlreadyExists: Taken("mesh", "face", "another mesh").
Fault Taken(const char* what, const std::string& id, const char* by);

// kLimitExceeded that names the quota: QuotaFull("max_sessions", 1000).
Fault QuotaFull(std::string_view quota, std::size_t limit);

// kLimitExceeded for a request that is itself too large, now and later.
Fault TooLarge(std::string_view what, std::string_view quota, std::size_t count, std::size_t limit);

// kOverloaded: a lane has no room for another job.
Fault Overloaded();

}  // namespace arap::app
