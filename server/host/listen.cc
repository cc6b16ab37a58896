#include "server/host/listen.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace arap::host {
namespace {

constexpr std::string_view kUnix = "unix:";
constexpr int kMaxPort = 65'535;

Fault Bad(const std::string& address, const char* why) {
  Fault fault{FaultKind::kInvalidOption,
              fmt::format("Cannot listen on {}: {}.", address, why),
              {},
              {},
              "listen"};
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

std::string BoundAddress(const std::string& address, int port) {
  if (!UnixPath(address).empty()) return address;
  return address.substr(0, address.rfind(':') + 1) + std::to_string(port);
}

}  // namespace arap::host
