// Calls to a server that has stopped reading, with more on their way than the connection holds: each
// ends when it was said to, though gRPC does not let go of it.
#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "arap/client/client.h"
#include "tests/support/bounded.h"

namespace arap::client {
namespace {

using std::chrono::milliseconds;
using testing::Answer;

// Says that it takes two gigabytes, of every stream and in all, and takes nothing.
constexpr std::uint8_t kGreeting[] = {
    0, 0, 6, 4, 0, 0, 0, 0, 0, 0,    4,    0x7F, 0xFF, 0xFF, 0xFF,  // SETTINGS: of a stream
    0, 0, 4, 8, 0, 0, 0, 0, 0, 0x7F, 0xFF, 0,    0,                 // WINDOW_UPDATE: in all
    0, 0, 0, 4, 1, 0, 0, 0, 0,                                      // SETTINGS are read
};

class DeafServer {
 public:
  DeafServer() : listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    auto* const plain = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(bind(listener_, plain, size), 0);
    EXPECT_EQ(getsockname(listener_, plain, &size), 0);
    EXPECT_EQ(listen(listener_, 8), 0);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    greeter_.emplace("what greets", [this] { Greet(); });
  }
  ~DeafServer() { Close(); }
  DeafServer(const DeafServer&) = delete;
  DeafServer& operator=(const DeafServer&) = delete;

  const std::string& address() const { return address_; }

  // Once; nothing is there any more.
  void Close() {
    if (!greeter_) return;
    shutdown(listener_, SHUT_RDWR);
    greeter_.reset();
    close(listener_);
    for (const int guest : guests_) close(guest);
  }

 private:
  void Greet() {
    for (;;) {
      const int guest = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
      if (guest < 0) return;
      guests_.push_back(guest);
      send(guest, kGreeting, sizeof kGreeting, MSG_NOSIGNAL);
    }
  }

  int listener_;
  std::string address_;
  std::vector<int> guests_;  // of greeter_ while it is there
  std::optional<testing::BoundedThread> greeter_;
};

class UnreadCallsTest : public ::testing::Test {
 protected:
  // How a call ends, which a test does not wait for longer than others.
  static Status End(const std::string& what, const std::function<Status()>& call) {
    std::packaged_task<Status()> task(call);
    auto status = task.get_future();
    std::thread thread(std::move(task));
    Status ended = Answer(status, what);
    thread.join();
    return ended;
  }

  // Of some megabytes, which nobody looks at.
  Status Upload(const CallOptions& call) {
    PlanarMesh mesh;
    mesh.vertices.assign(300'000, {1, 2});
    mesh.triangles.assign(600'000, {0, 1, 2});
    return End("an upload that is not read",
               [&] { return session_->RegisterMesh(mesh, {}, "m", call).map([](const auto&) {}); });
  }

  DeafServer server_;
  std::optional<Client> client_ = Client::Connect(server_.address());
  std::optional<Session> session_ = client_->AttachSession("s");
};

TEST_F(UnreadCallsTest, AnUploadEndsAtItsDeadline) {
  const Status upload = Upload({.timeout = milliseconds(500)});
  ASSERT_FALSE(upload);
  EXPECT_EQ(upload.error().kind, FaultKind::kDeadlineExceeded) << upload.error().message;
}

TEST_F(UnreadCallsTest, AnUploadEndsWhenItsCallerStops) {
  std::stop_source stop;
  std::thread stopper([&] { stop.request_stop(); });
  const Status upload = Upload({.stop = stop.get_token()});
  stopper.join();
  ASSERT_FALSE(upload);
  EXPECT_EQ(upload.error().kind, FaultKind::kCancelled) << upload.error().message;
}

TEST_F(UnreadCallsTest, CallsBehindAnUploadEndAtTheirs) {
  ASSERT_FALSE(Upload({.timeout = milliseconds(500)}));
  const CallOptions quick{.timeout = milliseconds(300)};
  const auto expect_late = [](const Status& status) {
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().kind, FaultKind::kDeadlineExceeded) << status.error().message;
  };
  expect_late(
      End("a look at the session", [&] { return session_->Get(quick).map([](const auto&) {}); }));
  const std::vector<std::string> ids{"r"};
  const std::vector<std::vector<Target>> frames(3, {{Complex(9, 1)}});
  expect_late(End("a track", [&] {
    return session_->DeformTrack(
        "h", ids, frames, {}, [](const Shape&) { return true; }, quick);
  }));
  expect_late(End("a job",
                  [&] { return session_->WatchJob("j", nullptr, quick).map([](const auto&) {}); }));
}

TEST_F(UnreadCallsTest, AClientMayGoWhileItsCallHangs) {
  ASSERT_FALSE(Upload({.timeout = milliseconds(500)}));
  session_.reset();
  client_.reset();
  // Now gRPC ends the call, and another one of the process clears it away.
  server_.Close();
  const DeafServer other;
  const auto info = Client::Connect(other.address()).GetServerInfo({.timeout = milliseconds(300)});
  EXPECT_FALSE(info);
}

}  // namespace
}  // namespace arap::client
