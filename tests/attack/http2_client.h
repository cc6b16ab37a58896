// Http2Client: the client's side of HTTP/2 by hand, so that calls may be begun and not finished. It
// keeps to the windows that the server grants and answers its settings and pings.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace arap::attack {

class Http2Client {
 public:
  using Headers = std::vector<std::pair<std::string, std::string>>;

  // Connects from the address `from` ("127.0.0.2"): a server that counts connections by address
  // counts ours apart from everybody else's.
  Http2Client(const std::string& address, const std::string& from);
  ~Http2Client();
  Http2Client(Http2Client&& other) noexcept;
  Http2Client& operator=(Http2Client&& other) noexcept;
  Http2Client(const Http2Client&) = delete;
  Http2Client& operator=(const Http2Client&) = delete;

  bool open() const { return socket_ >= 0; }

  // HEADERS of a gRPC call. Answers its stream, 0 when the connection has ended.
  std::uint32_t OpenCall(std::string_view path, const Headers& more = {});
  // `bytes` of the call's body; false when the connection or the call has ended, or the server
  // grants no window for `timeout`.
  bool Send(std::uint32_t stream, std::string_view bytes, bool last,
            std::chrono::milliseconds timeout = std::chrono::seconds(5));
  // Takes a call back (RST_STREAM); false when the connection has ended.
  bool Reset(std::uint32_t stream);
  // Reads what the server says and answers it, for at most `timeout`.
  void Pump(std::chrono::milliseconds timeout);

 private:
  bool Write(std::string_view bytes);
  void Handle(std::uint8_t type, std::uint8_t flags, std::uint32_t stream,
              std::string_view payload);
  void Close();

  int socket_ = -1;
  std::uint32_t next_ = 1;
  std::int64_t initial_window_ = 65'535;
  std::int64_t window_ = 65'535;                   // of the connection
  std::map<std::uint32_t, std::int64_t> windows_;  // of streams that have not ended
  std::string received_;
};

// A TCP connection to `address` (host:port, in numbers) from the address `from`; -1 when there is
// none. The caller closes it.
int ConnectTo(const std::string& address, const std::string& from);

// The five bytes before a gRPC message.
std::string MessagePrefix(bool compressed, std::size_t length);

}  // namespace arap::attack
