// Where a client of the tests comes from.
#pragma once

#include <cstdint>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace arap::rpc {

inline sockaddr_storage Peer(const char* address, int port) {
  sockaddr_storage peer{};
  auto& four = reinterpret_cast<sockaddr_in&>(peer);
  four.sin_family = AF_INET;
  four.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, address, &four.sin_addr);
  return peer;
}

}  // namespace arap::rpc
