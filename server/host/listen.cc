#include "server/host/listen.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace arap::host {
namespace {

constexpr std::string_view kUnix = "unix:";
constexpr int kMaxPort = 65'535;

Fault Bad(const std::string& address, const char* why) {
  Fault fault =
      Fault(FaultKind::kInvalidOption, fmt::format("Cannot listen on {}: {}.", address, why))
          .Field("listen");
  return fault.Detail("address", address);
}

Fault Taken(const std::string& address, const char* why) {
  Fault fault = Bad(address, why);
  fault.kind = FaultKind::kAlreadyExists;
  return fault;
}

// Whether connecting to the socket reaches somebody.
bool Answers(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), name.sun_path);
  const int socket_fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket_fd < 0) return true;  // better refuse than remove a living socket
  const int connected = connect(socket_fd, reinterpret_cast<const sockaddr*>(&name), sizeof(name));
  const bool refused = connected != 0 && errno == ECONNREFUSED;
  close(socket_fd);
  return !refused;
}

Status PrepareUnix(const std::string& address, const std::string& path) {
  if (path.size() >= sizeof(sockaddr_un{}.sun_path)) {
    return Fail(Bad(address, "the path is too long for a socket"));
  }
  struct stat info {};
  if (lstat(path.c_str(), &info) != 0) return {};  // free; binding tells the rest
  if (!S_ISSOCK(info.st_mode)) return Fail(Taken(address, "the path is there and not a socket"));
  if (Answers(path)) return Fail(Taken(address, "another server listens on it"));
  if (unlink(path.c_str()) != 0) {
    return Fail(Taken(address, "the socket left behind cannot be removed"));
  }
  return {};
}

bool IsPort(std::string_view port) {
  if (port.empty() || port.size() > 5) return false;
  int value = 0;
  for (const char c : port) {
    if (c < '0' || c > '9') return false;
    value = value * 10 + (c - '0');
  }
  return value <= kMaxPort;
}

}  // namespace

std::string UnixPath(std::string_view address) {
  return address.starts_with(kUnix) ? std::string(address.substr(kUnix.size())) : std::string();
}

Status PrepareAddress(const std::string& address) {
  if (const std::string path = UnixPath(address); !path.empty()) return PrepareUnix(address, path);
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0 || !IsPort(address.substr(colon + 1))) {
    return Fail(Bad(address, "give host:port or unix:PATH"));
  }
  return {};
}

bool IsLocal(std::string_view address) {
  if (address.starts_with(kUnix)) return true;
  std::string host(address.substr(0, address.rfind(':')));
  if (host == "localhost") return true;
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  constexpr in_addr_t kLoopback = 127;
  in_addr four{};
  if (inet_pton(AF_INET, host.c_str(), &four) == 1) {
    return ntohl(four.s_addr) >> 24u == kLoopback;
  }
  in6_addr six{};
  return inet_pton(AF_INET6, host.c_str(), &six) == 1 && IN6_IS_ADDR_LOOPBACK(&six);
}

Status CheckExposure(const std::vector<std::string>& addresses, const Exposure& exposure) {
  for (const std::string& address : addresses) {
    if (IsLocal(address) || exposure.allow_plaintext) continue;
    Fault fault = Fault(FaultKind::kPermissionDenied, {}).Field("listen");
    if (!exposure.tls) {
      fault.message = fmt::format(
          "{} is open to the network and would be plaintext: give --tls-cert and --tls-key, listen "
          "on loopback or a unix socket, or say --{}.",
          address, kAllowPlaintextFlag);
      return Fail(fault.Detail("address", address));
    }
    if (!exposure.identity && !exposure.allow_anyone) {
      fault.message = fmt::format(
          "{} is open to the network and nobody would be asked who they are: give --token-file or "
          "--tls-client-ca with --require-client-cert, or say --{}.",
          address, kAllowAnyoneFlag);
      return Fail(fault.Detail("address", address));
    }
  }
  return {};
}

std::string BoundAddress(const std::string& address, int port) {
  if (!UnixPath(address).empty()) return address;
  return address.substr(0, address.rfind(':') + 1) + std::to_string(port);
}

}  // namespace arap::host
