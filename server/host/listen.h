// Listen addresses: "host:port", port 0 for any free one, or "unix:PATH".
#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"

namespace arap::host {

// The path of a unix socket, empty for other addresses.
std::string UnixPath(std::string_view address);

// Makes the address ready to be bound: kInvalidOption for one that is not of the forms above, or
// whose path is too long for a socket; kAlreadyExists when somebody answers on the socket or the
// path is not a socket. A socket file that nobody answers on is removed.
Status PrepareAddress(const std::string& address);

// The address with the port that was bound in the place of its own.
std::string BoundAddress(const std::string& address, int port);

}  // namespace arap::host
