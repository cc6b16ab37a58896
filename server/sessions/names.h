// Faults about what clients name on the server: sessions, meshes, handle sets, and their quotas.
// What a name may be is in core/base/names.h.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "core/base/names.h"

namespace arap::app {

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
