// Names for new sessions.
#pragma once

#include <string>

namespace arap::client::internal {

// 128 random bits in hexadecimal, from the system's generator: the id is all that keeps others out.
std::string NewSessionId();

}  // namespace arap::client::internal
