// RawPeer: a TCP connection that says whatever it likes, and the few frames of HTTP/2 to say it in.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace arap::fault {

class RawPeer {
 public:
  // Connects to "127.0.0.1:PORT"; a failure of the test when that fails.
  explicit RawPeer(const std::string& address);
  ~RawPeer();
  RawPeer(RawPeer&& other) noexcept;
  RawPeer(const RawPeer&) = delete;
  RawPeer& operator=(const RawPeer&) = delete;

  // Sends all of it; false when the server has closed or does not take it within `timeout`. What
  // the server says meanwhile is read and dropped.
  bool Send(std::string_view bytes, std::chrono::milliseconds timeout = std::chrono::seconds(10));
  // Reads and drops until the server closes: false when it does not within `timeout`.
  bool IsClosed(std::chrono::milliseconds timeout = std::chrono::seconds(10));
  // Says that nothing more will come; the server may still send.
  void HalfClose();

 private:
  int socket_ = -1;
};

namespace http2 {

// The client's preface and an empty SETTINGS frame.
std::string Preface();
std::string Frame(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
                  std::string_view payload);
// HEADERS that open a gRPC call of `path` on `stream` (odd, growing), without the end of the
// stream. `more` headers have names and values shorter than 127 bytes.
std::string OpenCall(std::uint32_t stream, std::string_view path,
                     const std::vector<std::pair<std::string, std::string>>& more = {});
// DATA with the prefix of a gRPC message that claims `length` bytes, then `payload`.
std::string Message(std::uint32_t stream, std::uint32_t length, std::string_view payload);

inline constexpr std::uint8_t kData = 0, kHeaders = 1, kResetStream = 3, kSettings = 4, kPing = 6,
                              kGoAway = 7, kWindowUpdate = 8, kContinuation = 9;

}  // namespace http2
}  // namespace arap::fault
