#include "tests/attack/http2_client.h"

#include <algorithm>
#include <array>
#include <cerrno>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/system/fault/raw_peer.h"

namespace arap::attack {
namespace {

using fault::http2::Frame;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kFrameHeader = 9;
constexpr std::size_t kMostData = 16'384;
constexpr std::uint8_t kAck = 1, kEndStream = 1;
constexpr std::uint16_t kInitialWindowSize = 4;
constexpr milliseconds kWritePatience{5'000};

std::uint32_t BigEndian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (const char byte : bytes) value = value << 8u | static_cast<std::uint8_t>(byte);
  return value;
}

sockaddr_in Address(const std::string& host, const std::string& port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
  inet_pton(AF_INET, host.c_str(), &address.sin_addr);
  return address;
}

}  // namespace

int ConnectTo(const std::string& address, const std::string& from) {
  const std::size_t colon = address.rfind(':');
  const sockaddr_in target = Address(address.substr(0, colon), address.substr(colon + 1));
  const sockaddr_in source = Address(from, "0");
  const int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connection < 0) return -1;
  if (bind(connection, reinterpret_cast<const sockaddr*>(&source), sizeof source) == 0 &&
      connect(connection, reinterpret_cast<const sockaddr*>(&target), sizeof target) == 0) {
    return connection;
  }
  close(connection);
  return -1;
}

Http2Client::Http2Client(const std::string& address, const std::string& from)
    : socket_(ConnectTo(address, from)) {
  if (open()) Write(fault::http2::Preface());
}

Http2Client::Http2Client(Http2Client&& other) noexcept { *this = std::move(other); }

Http2Client& Http2Client::operator=(Http2Client&& other) noexcept {
  std::swap(socket_, other.socket_);  // the other one closes ours
  next_ = other.next_;
  initial_window_ = other.initial_window_;
  window_ = other.window_;
  windows_ = std::move(other.windows_);
  received_ = std::move(other.received_);
  return *this;
}

Http2Client::~Http2Client() { Close(); }

void Http2Client::Close() {
  if (socket_ >= 0) close(std::exchange(socket_, -1));
}

std::uint32_t Http2Client::OpenCall(std::string_view path, const Headers& more) {
  const std::uint32_t stream = std::exchange(next_, next_ + 2);
  if (!Write(fault::http2::OpenCall(stream, path, more))) return 0;
  windows_[stream] = initial_window_;
  return stream;
}

bool Http2Client::Send(std::uint32_t stream, std::string_view bytes, bool last,
                       milliseconds timeout) {
  const auto deadline = steady_clock::now() + timeout;
  while (open()) {
    const auto window = windows_.find(stream);
    if (window == windows_.end()) return false;
    const auto room = std::min({window_, window->second, static_cast<std::int64_t>(kMostData)});
    if (room <= 0 && !bytes.empty()) {
      if (steady_clock::now() > deadline) return false;
      Pump(milliseconds(20));
      continue;
    }
    const std::string_view now =
        bytes.substr(0, static_cast<std::size_t>(std::max<std::int64_t>(0, room)));
    bytes.remove_prefix(now.size());
    const bool ends = last && bytes.empty();
    if (!Write(Frame(fault::http2::kData, ends ? kEndStream : 0, stream, now))) return false;
    window_ -= static_cast<std::int64_t>(now.size());
    window->second -= static_cast<std::int64_t>(now.size());
    if (bytes.empty()) return true;
  }
  return false;
}

bool Http2Client::Reset(std::uint32_t stream) {
  constexpr std::string_view kCancel("\0\0\0\x08", 4);
  windows_.erase(stream);
  return Write(Frame(fault::http2::kResetStream, 0, stream, kCancel));
}

bool Http2Client::Write(std::string_view bytes) {
  const auto deadline = steady_clock::now() + kWritePatience;
  while (!bytes.empty() && open()) {
    const ssize_t count = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN && steady_clock::now() < deadline) {
      Pump(milliseconds(10));
    } else if (errno != EINTR) {
      Close();
    }
  }
  return open();
}

void Http2Client::Pump(milliseconds timeout) {
  if (!open()) return;
  pollfd wait{socket_, POLLIN, 0};
  if (poll(&wait, 1, static_cast<int>(timeout.count())) <= 0) return;
  std::array<char, 65'536> buffer{};
  const ssize_t count = recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return Close();
  if (count > 0) received_.append(buffer.data(), static_cast<std::size_t>(count));
  // Answering may read more, which comes after what is here.
  const std::string all = std::exchange(received_, {});
  std::string_view frames = all;
  while (frames.size() >= kFrameHeader) {
    const std::size_t length = BigEndian(frames.substr(0, 3));
    if (frames.size() < kFrameHeader + length) break;
    Handle(static_cast<std::uint8_t>(frames[3]), static_cast<std::uint8_t>(frames[4]),
           BigEndian(frames.substr(5, 4)) & 0x7FFF'FFFFu, frames.substr(kFrameHeader, length));
    frames.remove_prefix(kFrameHeader + length);
  }
  received_.insert(0, frames);
}

void Http2Client::Handle(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
                         std::string_view payload) {
  namespace http2 = fault::http2;
  if (type == http2::kSettings && (flags & kAck) == 0) {
    for (; payload.size() >= 6; payload.remove_prefix(6)) {
      if (BigEndian(payload.substr(0, 2)) != kInitialWindowSize) continue;
      const std::int64_t window = BigEndian(payload.substr(2, 4));
      for (auto& [id, left] : windows_) left += window - initial_window_;
      initial_window_ = window;
    }
    Write(Frame(http2::kSettings, kAck, 0, {}));
  } else if (type == http2::kPing && (flags & kAck) == 0) {
    Write(Frame(http2::kPing, kAck, 0, payload));
  } else if (type == http2::kWindowUpdate && payload.size() == 4) {
    const std::int64_t more = BigEndian(payload) & 0x7FFF'FFFFu;
    if (stream == 0) {
      window_ += more;
    } else if (const auto found = windows_.find(stream); found != windows_.end()) {
      found->second += more;
    }
  } else if (type == http2::kResetStream ||
             (type == http2::kHeaders && (flags & kEndStream) != 0)) {
    windows_.erase(stream);
  }
}

std::string MessagePrefix(bool compressed, std::size_t length) {
  std::string prefix(1, compressed ? '\1' : '\0');
  for (int shift = 24; shift >= 0; shift -= 8) {
    prefix.push_back(static_cast<char>(length >> static_cast<unsigned>(shift) & 0xFFu));
  }
  return prefix;
}

}  // namespace arap::attack
