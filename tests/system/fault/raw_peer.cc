#include "tests/system/fault/raw_peer.h"

#include <array>
#include <cerrno>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace arap::fault {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// Reads and drops what there is; false at the end of the connection.
bool Drop(int socket) {
  std::array<char, 65'536> buffer{};
  const ssize_t count = recv(socket, buffer.data(), buffer.size(), MSG_DONTWAIT);
  return count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
}

short Await(int socket, short events, steady_clock::time_point deadline) {
  const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now()).count();
  pollfd wait{socket, events, 0};
  return poll(&wait, 1, left > 0 ? static_cast<int>(left) : 0) > 0 ? wait.revents : short{0};
}

void AppendBigEndian(std::uint32_t value, int bytes, std::string& out) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
    out.push_back(static_cast<char>(value >> static_cast<unsigned>(shift) & 0xFFu));
  }
}

// A literal header field that is not indexed, its strings shorter than 127 bytes and not Huffman's.
void AppendHeader(std::string_view name, std::string_view value, std::string& out) {
  out.push_back(0);
  out.push_back(static_cast<char>(name.size()));
  out += name;
  out.push_back(static_cast<char>(value.size()));
  out += value;
}

}  // namespace

RawPeer::RawPeer(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  sockaddr_in target{};
  target.sin_family = AF_INET;
  target.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1))));
  EXPECT_EQ(inet_pton(AF_INET, address.substr(0, colon).c_str(), &target.sin_addr), 1) << address;
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&target), sizeof target), 0)
      << address;
}

RawPeer::RawPeer(RawPeer&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

RawPeer::~RawPeer() {
  if (socket_ >= 0) close(socket_);
}

bool RawPeer::Send(std::string_view bytes, milliseconds timeout) {
  const auto deadline = steady_clock::now() + timeout;
  while (!bytes.empty()) {
    const short events = Await(socket_, POLLIN | POLLOUT, deadline);
    if (events == 0) return false;
    if ((events & POLLIN) != 0 && !Drop(socket_)) return false;
    if ((events & (POLLOUT | POLLERR | POLLHUP)) == 0) continue;
    const ssize_t count = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno != EAGAIN && errno != EINTR) {
      return false;
    }
  }
  return true;
}

bool RawPeer::IsClosed(milliseconds timeout) {
  const auto deadline = steady_clock::now() + timeout;
  while (Await(socket_, POLLIN, deadline) != 0) {
    if (!Drop(socket_)) return true;
  }
  return false;
}

void RawPeer::HalfClose() { shutdown(socket_, SHUT_WR); }

namespace http2 {

std::string Preface() { return "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Frame(kSettings, 0, 0, {}); }

std::string Frame(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
                  std::string_view payload) {
  std::string frame;
  AppendBigEndian(static_cast<std::uint32_t>(payload.size()), 3, frame);
  AppendBigEndian(type, 1, frame);
  AppendBigEndian(flags, 1, frame);
  AppendBigEndian(stream, 4, frame);
  return frame += payload;
}

std::string OpenCall(std::uint32_t stream, std::string_view path,
                     const std::vector<std::pair<std::string, std::string>>& more) {
  constexpr std::uint8_t kEndHeaders = 4;
  std::string block;
  AppendHeader(":method", "POST", block);
  AppendHeader(":scheme", "http", block);
  AppendHeader(":path", path, block);
  AppendHeader(":authority", "localhost", block);
  AppendHeader("te", "trailers", block);
  AppendHeader("content-type", "application/grpc", block);
  for (const auto& [name, value] : more) AppendHeader(name, value, block);
  return Frame(kHeaders, kEndHeaders, stream, block);
}

std::string Message(std::uint32_t stream, std::uint32_t length, std::string_view payload) {
  std::string message(1, '\0');
  AppendBigEndian(length, 4, message);
  message += payload;
  return Frame(kData, 0, stream, message);
}

}  // namespace http2
}  // namespace arap::fault
