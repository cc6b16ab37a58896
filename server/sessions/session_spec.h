// What a client may ask of sessions, checked.
#pragma once

#include <cstddef>
#include <string>

#include "arap/base/result.h"
#include "server/budget/limits.h"
#include "server/sessions/session.h"

namespace arap::app {

// kInvalidName and kInvalidOption with the field of CreateSession.
Status CheckSpec(const SessionSpec& spec, const Limits& limits);

// kInvalidOption with the field of ListSessions.
Status CheckPage(std::size_t size, const std::string& token);

}  // namespace arap::app
