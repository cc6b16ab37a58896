#include "tests/server/store/lossy_proxy.h"

#include <array>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace arap::testing {
namespace {

constexpr int kLookMs = 20;  // at whether it is to end

sockaddr_in Here(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<in_port_t>(port));
  return address;
}

// Passes on what there is; false when there will be no more.
bool PassOn(int from, int to) {
  std::array<char, 65536> buffer{};
  const ssize_t got = recv(from, buffer.data(), buffer.size(), 0);
  return got > 0 && send(to, buffer.data(), static_cast<std::size_t>(got), MSG_NOSIGNAL) == got;
}

}  // namespace

LossyProxy::LossyProxy(int redis_port)
    : redis_port_(redis_port), listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address = Here(0);
  socklen_t size = sizeof address;
  auto* any = reinterpret_cast<sockaddr*>(&address);
  if (bind(listener_, any, size) != 0 || listen(listener_, 16) != 0 ||
      getsockname(listener_, any, &size) != 0) {
    throw std::runtime_error("the proxy cannot listen");
  }
  port_ = ntohs(address.sin_port);
  thread_.emplace("the proxy", [this] { Serve(); });
}

LossyProxy::~LossyProxy() {
  stop_ = true;
  thread_.reset();
  close(listener_);
}

std::string LossyProxy::Url() const { return "redis://127.0.0.1:" + std::to_string(port_); }

void LossyProxy::Serve() {
  while (!stop_) {
    pollfd wait{listener_, POLLIN, 0};
    if (poll(&wait, 1, kLookMs) <= 0) continue;
    const int client = accept(listener_, nullptr, nullptr);
    if (client < 0) continue;
    Pass(client);
    close(client);
  }
}

void LossyProxy::Pass(int client) {
  const int redis = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = Here(redis_port_);
  bool open = connect(redis, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  while (open && !stop_) {
    std::array<pollfd, 2> ends{{{client, POLLIN, 0}, {redis, POLLIN, 0}}};
    poll(ends.data(), ends.size(), kLookMs);
    if (ends[1].revents != 0 && lose_.exchange(false)) {
      ++lost_;
      break;
    }
    if (ends[1].revents != 0) open = PassOn(redis, client);
    if (open && ends[0].revents != 0) open = PassOn(client, redis);
  }
  close(redis);
}

}  // namespace arap::testing
