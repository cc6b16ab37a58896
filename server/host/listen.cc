#include "server/host/listen.h"

#include <algorithm>
#include <cerrno>
#include <charconv>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/base/try.h"

namespace arap::host {
namespace {

constexpr std::string_view kUnix = "unix:";
constexpr int kMaxPort = 65'535;
constexpr int kBacklog = 4'096;

Fault Bad(const Purpose& purpose, const std::string& address, const char* why) {
  return Fault(FaultKind::kInvalidOption, fmt::format("{} {}: {}.", purpose.sentence, address, why))
      .Field(purpose.field)
      .Detail("address", address);
}

Fault Taken(const Purpose& purpose, const std::string& address, const char* why) {
  Fault fault = Bad(purpose, address, why);
  fault.kind = FaultKind::kAlreadyExists;
  return fault;
}

sockaddr_un UnixName(const std::string& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  std::copy(path.begin(), path.end(), name.sun_path);
  return name;
}

// Whether connecting to the socket reaches somebody.
bool Answers(const std::string& path) {
  const sockaddr_un name = UnixName(path);
  const Descriptor peer(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (peer.number() < 0) return true;  // better refuse than remove a living socket
  const auto* to = reinterpret_cast<const sockaddr*>(&name);
  return connect(peer.number(), to, sizeof name) == 0 || errno != ECONNREFUSED;
}

// The path is free, or what is there may go.
Status MakeWay(const Purpose& purpose, const std::string& address, const std::string& path) {
  struct stat info {};
  if (lstat(path.c_str(), &info) != 0) return {};  // free; binding tells the rest
  if (!S_ISSOCK(info.st_mode)) {
    return Fail(Taken(purpose, address, "the path is there and not a socket"));
  }
  if (Answers(path)) return Fail(Taken(purpose, address, "another server listens on it"));
  if (unlink(path.c_str()) != 0) {
    return Fail(Taken(purpose, address, "the socket left behind cannot be removed"));
  }
  return {};
}

// A listening socket, or none.
Descriptor Bind(const sockaddr* name, socklen_t size, bool both_families) {
  const int family = name->sa_family;
  Descriptor bound(socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (bound.number() < 0) return {};
  const int yes = 1, only = both_families ? 0 : 1;
  // Not SO_REUSEPORT, which would let another process share the port.
  if (family != AF_UNIX) {
    setsockopt(bound.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  }
  if (family == AF_INET6) {
    setsockopt(bound.number(), IPPROTO_IPV6, IPV6_V6ONLY, &only, sizeof only);
  }
  if (bind(bound.number(), name, size) != 0 || listen(bound.number(), kBacklog) != 0) return {};
  return bound;
}

int PortOf(const Descriptor& bound) {
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  if (getsockname(bound.number(), reinterpret_cast<sockaddr*>(&name), &size) != 0) return 0;
  return ntohs(name.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(name).sin6_port
                                          : reinterpret_cast<const sockaddr_in&>(name).sin_port);
}

// Sockets on every address of the host, with one port for all; none when it cannot be had.
std::vector<Descriptor> BindHost(const std::string& host, int port) {
  std::vector<Descriptor> sockets;
  if (host == "0.0.0.0" || host == "::") {
    sockaddr_in6 any{};
    any.sin6_family = AF_INET6;
    any.sin6_port = htons(static_cast<std::uint16_t>(port));
    Descriptor both = Bind(reinterpret_cast<const sockaddr*>(&any), sizeof any, true);
    if (both.number() >= 0) {
      sockets.push_back(std::move(both));
      return sockets;
    }
  }
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* first = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &first) != 0) return sockets;
  for (const addrinfo* at = first; at != nullptr; at = at->ai_next) {
    if (at->ai_family == AF_INET) {
      reinterpret_cast<sockaddr_in*>(at->ai_addr)->sin_port =
          htons(static_cast<std::uint16_t>(port));
    } else if (at->ai_family == AF_INET6) {
      reinterpret_cast<sockaddr_in6*>(at->ai_addr)->sin6_port =
          htons(static_cast<std::uint16_t>(port));
    }
    Descriptor bound = Bind(at->ai_addr, at->ai_addrlen, false);
    if (bound.number() < 0) continue;
    if (port == 0) port = PortOf(bound);
    sockets.push_back(std::move(bound));
  }
  freeaddrinfo(first);
  return sockets;
}

// "127.0.0.1:9464", "[::1]:9464" or "name:9464" in its parts; the port is -1 when it is none.
std::pair<std::string, int> HostAndPort(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos || colon == 0) return {{}, -1};
  std::string host = address.substr(0, colon);
  const char* end = address.data() + address.size();
  int port = -1;
  const auto [stop, error] = std::from_chars(address.data() + colon + 1, end, port);
  if (error != std::errc() || stop != end || port < 0 || port > kMaxPort) port = -1;
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return {host, port};
}

}  // namespace

Descriptor::~Descriptor() {
  if (number_ >= 0) close(number_);
}

Result<Listening> Listening::Open(const std::string& address, const Purpose& purpose, mode_t mode) {
  CHECK_OK(CheckAddress(address, purpose));
  Listening listening;
  listening.address_ = address;
  const std::string path = UnixPath(address);
  if (path.empty()) {
    const auto [host, port] = HostAndPort(address);
    listening.sockets_ = BindHost(host, port);
    if (listening.sockets_.empty()) {
      return Fail(Taken(purpose, address, "it is in use or not an address of this machine"));
    }
    listening.address_ = address.substr(0, address.rfind(':') + 1) +
                         std::to_string(PortOf(listening.sockets_.front()));
    return listening;
  }
  CHECK_OK(MakeWay(purpose, address, path));
  const sockaddr_un name = UnixName(path);
  Descriptor bound = Bind(reinterpret_cast<const sockaddr*>(&name), sizeof name, false);
  struct stat info {};
  if (bound.number() < 0 || chmod(path.c_str(), mode) != 0 || lstat(path.c_str(), &info) != 0) {
    return Fail(Taken(purpose, address, "no socket can be made there"));
  }
  listening.sockets_.push_back(std::move(bound));
  listening.path_ = path;
  listening.device_ = info.st_dev;
  listening.inode_ = info.st_ino;
  return listening;
}

Listening::~Listening() {
  struct stat info {};
  if (path_.empty() || lstat(path_.c_str(), &info) != 0) return;
  if (info.st_dev == device_ && info.st_ino == inode_) unlink(path_.c_str());
}

std::string UnixPath(std::string_view address) {
  return address.starts_with(kUnix) ? std::string(address.substr(kUnix.size())) : std::string();
}

Status CheckAddress(const std::string& address, const Purpose& purpose) {
  if (const std::string path = UnixPath(address); !path.empty()) {
    if (path.size() < sizeof(sockaddr_un{}.sun_path)) return {};
    return Fail(Bad(purpose, address, "the path is too long for a socket"));
  }
  if (HostAndPort(address).second >= 0) return {};
  return Fail(Bad(purpose, address, "give host:port or unix:PATH"));
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

}  // namespace arap::host
