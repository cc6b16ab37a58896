#include "server/rpc/peer.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <arpa/inet.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace arap::rpc {
namespace {

// An IPv4 address that came in on a socket of both families is one.
std::uint32_t MappedIPv4(const in6_addr& address) {
  std::uint32_t four = 0;
  if (IN6_IS_ADDR_V4MAPPED(&address)) std::memcpy(&four, &address.s6_addr[12], sizeof four);
  return four;
}

std::string Text(int family, const void* address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  inet_ntop(family, address, text.data(), text.size());
  return text.data();
}

}  // namespace

std::string PeerName(const sockaddr_storage& peer) {
  if (peer.ss_family == AF_INET) {
    const auto& four = reinterpret_cast<const sockaddr_in&>(peer);
    return "ipv4:" + Text(AF_INET, &four.sin_addr) + ":" + std::to_string(ntohs(four.sin_port));
  }
  if (peer.ss_family != AF_INET6) return {};
  const auto& six = reinterpret_cast<const sockaddr_in6&>(peer);
  const std::string port = ":" + std::to_string(ntohs(six.sin6_port));
  if (const std::uint32_t four = MappedIPv4(six.sin6_addr); four != 0) {
    return "ipv4:" + Text(AF_INET, &four) + port;
  }
  return "ipv6:%5B" + Text(AF_INET6, &six.sin6_addr) + "%5D" + port;
}

std::string AddressOf(const sockaddr_storage& peer) {
  if (peer.ss_family == AF_INET) {
    return Text(AF_INET, &reinterpret_cast<const sockaddr_in&>(peer).sin_addr);
  }
  if (peer.ss_family != AF_INET6) return {};
  in6_addr network = reinterpret_cast<const sockaddr_in6&>(peer).sin6_addr;
  if (const std::uint32_t four = MappedIPv4(network); four != 0) return Text(AF_INET, &four);
  // A network of 64 bits is what one customer has.
  std::fill(std::begin(network.s6_addr) + 8, std::end(network.s6_addr), std::uint8_t{0});
  return Text(AF_INET6, &network);
}

std::uint64_t CookieOf(int descriptor) {
  std::uint64_t cookie = 0;
  socklen_t size = sizeof cookie;
  return getsockopt(descriptor, SOL_SOCKET, SO_COOKIE, &cookie, &size) == 0 ? cookie : 0;
}

std::uint64_t BytesOf(int descriptor) {
  tcp_info info{};
  socklen_t size = sizeof info;
  return getsockopt(descriptor, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 ? info.tcpi_bytes_received
                                                                          : 0;
}

void WithSocket(int descriptor, std::uint64_t cookie, const std::function<void(int)>& work) {
  const int copy = dup(descriptor);
  if (copy < 0) return;
  if (CookieOf(copy) == cookie) work(copy);
  close(copy);
}

void ShutDown(int socket) {
  shutdown(socket, SHUT_RDWR);
  // What is here already would still be read, thousands of calls perhaps.
  while (recv(socket, nullptr, std::size_t{1} << 20u, MSG_TRUNC | MSG_DONTWAIT) > 0) {
  }
}

void SetBuffer(int socket, int bytes) {
  setsockopt(socket, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
}

}  // namespace arap::rpc
