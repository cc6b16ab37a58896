// Peers: what they are called, and what the kernel knows of a connection that gRPC owns.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

struct sockaddr_storage;

namespace arap::rpc {

// gRPC's name of a peer ("ipv4:10.0.0.1:5555"), and what the connections of one address are counted
// by: an IPv4 address or an IPv6 network of 64 bits. Nothing for a unix socket.
std::string PeerName(const sockaddr_storage& peer);
std::string AddressOf(const sockaddr_storage& peer);

// The kernel's name of the socket, never given twice: a descriptor with another one is somebody
// else's by now. 0 for what is no socket.
std::uint64_t CookieOf(int descriptor);
// All that has come in on a TCP connection; 0 for what is none.
std::uint64_t BytesOf(int descriptor);
// Does something with the socket of that cookie if the descriptor still is that. `work` has a copy,
// which nobody else closes meanwhile.
void WithSocket(int descriptor, std::uint64_t cookie, const std::function<void(int socket)>& work);

// Ends the connection, and throws away what has come in on it.
void ShutDown(int socket);
// How much may wait in the kernel for being read.
void SetBuffer(int socket, int bytes);

}  // namespace arap::rpc
