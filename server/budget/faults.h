// The faults of requests that ask for what is not there, is taken already or is more than there may
// be.
#pragma once

#include <chrono>
#include <cstddef>
#include <string_view>

#include "arap/base/fault.h"

namespace arap::app {

// kNotFound for a session, a mesh or a handle set: NotFound("mesh", "face").
Fault NotFound(std::string_view what, std::string_view id);

// kAlreadyExists: Taken("mesh", "face", "another mesh").
Fault Taken(std::string_view what, std::string_view id, std::string_view by);

// kLimitExceeded that names the quota: QuotaFull("max_sessions", 1000).
Fault QuotaFull(std::string_view quota, std::size_t limit);

// kLimitExceeded for a request that is itself too large, now and later:
// TooLarge("The message", "max_message_bytes", 200, 100).
Fault TooLarge(std::string_view what, std::string_view quota, std::size_t count, std::size_t limit);

// kOverloaded: a lane has no room for another job.
Fault Overloaded();

// With the place that the request would have had and how long it would have waited, which is also
// when to try again.
Fault WithOutlook(Fault fault, std::size_t place, std::chrono::duration<double> wait);

// With no time to try again: the same request never fits.
Fault ForEver(Fault fault);

}  // namespace arap::app
