// A proxy that the environment names is asked for other machines, and never for this one.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "arap/client/client.h"
#include "tests/support/fake_server.h"

namespace arap::client {
namespace {

constexpr std::array kProxies{"grpc_proxy", "https_proxy", "http_proxy"};
constexpr std::array kExceptions{"no_grpc_proxy", "no_proxy"};

// The variables of the environment that name proxies; as they were after the test.
class ProxyTest : public ::testing::Test {
 protected:
  ProxyTest() {
    for (const char* name : kProxies) Keep(name);
    for (const char* name : kExceptions) Keep(name);
  }
  ~ProxyTest() override {
    for (const auto& [name, value] : before_) {
      if (value) {
        setenv(name, value->c_str(), 1);
      } else {
        unsetenv(name);
      }
    }
  }

 private:
  void Keep(const char* name) {
    const char* const value = std::getenv(name);
    before_.emplace_back(name, value == nullptr ? std::nullopt : std::optional<std::string>(value));
    unsetenv(name);
  }

  std::vector<std::pair<const char*, std::optional<std::string>>> before_;
};

// A listening socket of 127.0.0.1 on a free port.
class Listener {
 public:
  Listener() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* const plain = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(socket_, plain, size), 0);
    EXPECT_EQ(getsockname(socket_, plain, &size), 0);
    port_ = ntohs(address.sin_port);
  }
  ~Listener() { close(socket_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int port() const { return port_; }

  void Listen() const { EXPECT_EQ(listen(socket_, 1), 0); }
  // The first bytes that somebody sends who connects.
  std::string Hear() const {
    constexpr int kTimeoutMs = 30'000;
    pollfd waiting{socket_, POLLIN, 0};
    if (poll(&waiting, 1, kTimeoutMs) != 1) return "nobody came";
    const int guest = accept(socket_, nullptr, nullptr);
    std::array<char, 200> bytes{};
    const ssize_t count = recv(guest, bytes.data(), bytes.size(), 0);
    close(guest);
    return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }

 private:
  int socket_;
  int port_ = 0;
};

TEST_F(ProxyTest, ThisMachineIsReachedWithoutOne) {
  const arap::testing::FakeServer server;
  const std::string port = server.address().substr(server.address().rfind(':'));
  const Listener dead;  // bound and not listening: refuses everybody
  const std::string proxy = "http://127.0.0.1:" + std::to_string(dead.port());
  for (const char* name : kProxies) {
    setenv(name, proxy.c_str(), 1);
    for (const std::string host :
         {"127.0.0.1", "localhost", "dns:///127.0.0.1", "dns:localhost", "ipv4:127.0.0.1"}) {
      const Client client = Client::Connect(host + port);
      const auto info = client.GetServerInfo({std::chrono::seconds(10)});
      EXPECT_TRUE(info) << name << " " << host;
    }
    ConnectOptions options;
    options.token = "arapd_secret";
    const auto client = Client::Connect("localhost" + port, options);
    ASSERT_TRUE(client);
    EXPECT_TRUE(client->GetServerInfo({std::chrono::seconds(10)})) << name;
    unsetenv(name);
  }
}

TEST_F(ProxyTest, OtherMachinesAreReachedThroughIt) {
  Listener proxy;
  setenv("http_proxy", ("http://127.0.0.1:" + std::to_string(proxy.port())).c_str(), 1);
  proxy.Listen();
  const Client client = Client::Connect("arap.example:50051");
  std::stop_source stop;
  const std::jthread asking([&] {
    (void)client.GetServerInfo({std::chrono::seconds(30), stop.get_token()});
  });
  EXPECT_THAT(proxy.Hear(), ::testing::HasSubstr("CONNECT arap.example:50051"));
  stop.request_stop();
}

}  // namespace
}  // namespace arap::client
