// Two servers that share their sessions, behind the real haproxy with the configuration that we
// ship: what clients see when the server of their stream dies, drains or freezes.
#include <csignal>

#include <gtest/gtest.h>

#include "arap/client/client.h"
#include "tests/server/store/redis_server.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/haproxy.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

using client::DeformStream;
using std::chrono::seconds;

constexpr seconds kPatience{30};

class ProxyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    for (ServerProcess* server : {&a_, &b_}) {
      ASSERT_TRUE(server->Start());
      const auto admin = server->ReadLine("arapd admin on ", kPatience);
      ASSERT_TRUE(admin);
      backends_.push_back({server->address(), *admin});
    }
    ASSERT_TRUE(proxy_.Start(backends_));
    client_.emplace(client::Client::Connect(proxy_.address()));
    ASSERT_TRUE(Eventually([&] { return client_->GetServerInfo().has_value(); })) << proxy_.Log();
    auto session = client_->CreateSession();
    ASSERT_TRUE(session) << session.error().message;
    session_.emplace(*std::move(session));
    const PlanarMesh mesh{{{0, 0}, {4, 0}, {4, 4}, {0, 4}, {2, 2}},
                          {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
    const auto registered = session_->RegisterMesh(mesh, {}, "m");
    ASSERT_TRUE(registered) << registered.error().message;
    const std::vector<client::Handle> handles{{"l", client::VertexAnchor{0}},
                                              {"r", client::VertexAnchor{1}}};
    ASSERT_TRUE(session_->CompileHandles("h", "m", handles));
  }

  Result<DeformStream> Open(std::chrono::milliseconds resume_within = {}) {
    client::StreamOptions options{client::Delivery::kEvery, {.float64 = true}};
    options.resume_within = resume_within;
    return session_->OpenStream("h", options, {.timeout = kPatience});
  }

  // The answer to an update; empty when there is none.
  static std::vector<Complex> Drag(DeformStream& stream, std::uint64_t sequence, double x) {
    client::HandleUpdate update;
    update.sequence = sequence;
    update.positions = {{0, 0}, {x, 1}};
    (void)stream.Send(update);  // reading tells
    const auto event = stream.Read();
    if (!event || !*event) return {};
    const auto* shape = std::get_if<client::Shape>(&**event);
    return shape == nullptr ? std::vector<Complex>() : shape->positions;
  }

  // The one that has an open stream of the session.
  ServerProcess& Holder() {
    const std::string opened = "session=" + session_->id() + " event=open";
    return a_.Log().find(opened) != std::string::npos ? a_ : b_;
  }

  // After the loss of its server.
  static void ExpectGoesOn(DeformStream& stream, const std::vector<Complex>& shape) {
    const auto event = stream.Read();
    ASSERT_TRUE(event && *event) << event.error().message;
    EXPECT_TRUE(std::holds_alternative<client::Resumed>(**event));
    EXPECT_EQ(Drag(stream, 2, 5), shape);
  }

  testing::RedisServer redis_;
  TempFolder blobs_;
  const std::vector<std::string> flags_{"--store",     redis_.Url(),      "--blob-dir",
                                        blobs_.path(), "--drain-seconds", "5"};
  ServerProcess a_{flags_, "unix:{}/socket"};
  ServerProcess b_{flags_, "unix:{}/socket"};
  std::vector<Backend> backends_;
  Haproxy proxy_;
  std::optional<client::Client> client_;
  std::optional<client::Session> session_;
};

TEST_F(ProxyTest, ASessionStaysWithItsServer) {
  for (int round = 0; round < 6; ++round) {
    auto stream = Open();
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_FALSE(Drag(*stream, 1, 5).empty());
  }
  ServerProcess& other = &Holder() == &a_ ? b_ : a_;
  EXPECT_EQ(other.Log().find("session=" + session_->id()), std::string::npos);
}

TEST_F(ProxyTest, WhenItsServerDiesAStreamGoesOnWithTheOther) {
  auto stream = Open(kPatience);
  ASSERT_TRUE(stream) << stream.error().message;
  const std::vector<Complex> shape = Drag(*stream, 1, 5);
  ASSERT_FALSE(shape.empty());
  Holder().Kill();
  ExpectGoesOn(*stream, shape);
}

TEST_F(ProxyTest, WhenItsServerDrainsAStreamIsToldToOpenAgain) {
  auto stream = Open();
  auto resuming = Open(kPatience);
  ASSERT_TRUE(resuming) << resuming.error().message;
  ASSERT_TRUE(stream) << stream.error().message;
  const std::vector<Complex> shape = Drag(*stream, 1, 5);
  ASSERT_FALSE(shape.empty());
  ServerProcess& server = Holder();
  server.Signal(SIGTERM);
  const auto end = stream->Read();
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, FaultKind::kDraining);
  EXPECT_EQ(client::DetailOf(end.error(), "resume"), "open_again");
  ExpectGoesOn(*resuming, shape);
  EXPECT_EQ(server.Wait(kPatience), 0);
}

// It keeps its connections: only the checks of the proxy tell.
TEST_F(ProxyTest, WhenItsServerFreezesAStreamIsCutAndGoesOnWithTheOther) {
  auto stream = Open(kPatience);
  ASSERT_TRUE(stream) << stream.error().message;
  const std::vector<Complex> shape = Drag(*stream, 1, 5);
  ASSERT_FALSE(shape.empty());
  Holder().Signal(SIGSTOP);
  ExpectGoesOn(*stream, shape);
}

}  // namespace
}  // namespace arap::fault
