// Listen addresses: "host:port", port 0 for any free one, or "unix:PATH".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"

namespace arap::host {

// The path of a unix socket, empty for other addresses.
std::string UnixPath(std::string_view address);

// Makes the address ready to be bound: kInvalidOption for one that is not of the forms above, or
// whose path is too long for a socket; kAlreadyExists when somebody answers on the socket or the
// path is not a socket. A socket file that nobody answers on is removed.
Status PrepareAddress(const std::string& address);

// Whether only this machine reaches the address: a unix socket, 127.0.0.0/8, [::1] or localhost.
// Other host names are not looked up and count as the network.
bool IsLocal(std::string_view address);

// What an address beyond this machine may do without. See CheckExposure.
struct Exposure {
  bool tls = false;              // TCP addresses speak TLS
  bool identity = false;         // every caller has to say who it is
  bool allow_plaintext = false;  // to the network, and then without identity too
  bool allow_anyone = false;     // from the network, without identity
};

// kPermissionDenied with the first address that would serve the network in plaintext, or without
// asking who is there, unless that is allowed. The message names the flag that allows it.
Status CheckExposure(const std::vector<std::string>& addresses, const Exposure& exposure);

// The flags of arapd behind Exposure, without the dashes. Their names are the warning.
inline constexpr const char* kAllowPlaintextFlag =
    "i-know-this-is-plaintext-and-open-to-the-network";
inline constexpr const char* kAllowAnyoneFlag = "i-know-that-anyone-on-the-network-may-use-this";

// The address with the port that was bound in the place of its own.
std::string BoundAddress(const std::string& address, int port);

}  // namespace arap::host
