// Listen addresses: "host:port", port 0 for any free one, or "unix:PATH"; and the sockets that are
// bound to them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "arap/base/result.h"

namespace arap::host {

// A file descriptor that is closed when it goes. Move-only.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.Release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor();

  int number() const { return number_; }  // -1: none
  int Release() { return std::exchange(number_, -1); }

 private:
  int number_ = -1;
};

// What an address is for, in the faults about it.
struct Purpose {
  const char* field;
  const char* sentence;
};
inline constexpr Purpose kForCalls{"listen", "Cannot listen on"};
inline constexpr Purpose kForOperators{"admin", "Cannot serve the admin page on"};

// An address that is bound. The port is this process's alone. Move-only.
class Listening {
 public:
  // kInvalidOption for an address that is not of the forms above; kAlreadyExists for one that is
  // taken or not of this machine. The file of a unix socket gets `mode`; one that nobody answers on
  // is replaced.
  static Result<Listening> Open(const std::string& address, const Purpose& purpose,
                                mode_t mode = 0600);
  Listening(Listening&& other) noexcept = default;
  Listening& operator=(Listening&& other) noexcept = default;
  // Removes the file of a unix socket, unless it is another server's by now.
  ~Listening();

  // With the port that was bound.
  const std::string& address() const { return address_; }
  // Non-blocking. Several where a host name has several addresses.
  const std::vector<Descriptor>& sockets() const { return sockets_; }

 private:
  Listening() = default;
  std::string address_;
  std::vector<Descriptor> sockets_;
  std::string path_;  // of a unix socket; empty when there is nothing to remove
  std::uint64_t device_ = 0, inode_ = 0;
};

// The path of a unix socket, empty for other addresses.
std::string UnixPath(std::string_view address);

// kInvalidOption for an address that is not of the forms above, or whose path is too long for a
// socket. Looks at the text only.
Status CheckAddress(const std::string& address, const Purpose& purpose);

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

}  // namespace arap::host
