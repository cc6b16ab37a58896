// Two servers that share their sessions, behind the real haproxy with the configuration that we
// ship: what clients see when the server of their stream dies, drains or freezes.
#include <gtest/gtest.h>

#include "arap/client/client.h"
#include "tests/system/cluster/cluster.h"

namespace arap::cluster {
namespace {

using client::DeformStream;
using std::chrono::seconds;

constexpr seconds kPatience{30};

class ProxyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(cluster_.Start());
    client_.emplace(client::Client::Connect(cluster_.address()));
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

  // The server that has an open stream of the session.
  std::string Holder() const { return Knows("1") ? "1" : "2"; }
  bool Knows(const std::string& server) const {
    return cluster_.Log(server).find("session=" + session_->id()) != std::string::npos;
  }

  // After the loss of its server.
  static void ExpectGoesOn(DeformStream& stream, const std::vector<Complex>& shape) {
    const auto event = stream.Read();
    ASSERT_TRUE(event && *event) << event.error().message;
    EXPECT_TRUE(std::holds_alternative<client::Resumed>(**event));
    EXPECT_EQ(Drag(stream, 2, 5), shape);
  }

  Cluster cluster_{2};
  std::optional<client::Client> client_;
  std::optional<client::Session> session_;
};

TEST_F(ProxyTest, ASessionStaysWithItsServer) {
  for (int round = 0; round < 6; ++round) {
    auto stream = Open();
    ASSERT_TRUE(stream) << stream.error().message;
    EXPECT_FALSE(Drag(*stream, 1, 5).empty());
  }
  EXPECT_FALSE(Knows(Holder() == "1" ? "2" : "1"));
}

TEST_F(ProxyTest, WhenItsServerDiesAStreamGoesOnWithTheOther) {
  auto stream = Open(kPatience);
  ASSERT_TRUE(stream) << stream.error().message;
  const std::vector<Complex> shape = Drag(*stream, 1, 5);
  ASSERT_FALSE(shape.empty());
  cluster_.Do("kill", Holder());
  ExpectGoesOn(*stream, shape);
}

TEST_F(ProxyTest, WhenItsServerDrainsAStreamIsToldToOpenAgain) {
  auto stream = Open();
  auto resuming = Open(kPatience);
  ASSERT_TRUE(resuming) << resuming.error().message;
  ASSERT_TRUE(stream) << stream.error().message;
  const std::vector<Complex> shape = Drag(*stream, 1, 5);
  ASSERT_FALSE(shape.empty());
  const std::string server = Holder();
  const std::string drained = cluster_.Do("drain", server);
  const auto end = stream->Read();
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, FaultKind::kDraining);
  EXPECT_EQ(client::DetailOf(end.error(), "resume"), "open_again");
  ExpectGoesOn(*resuming, shape);
  EXPECT_EQ(drained, server + " ended with 0");
}

// It keeps its connections: only the checks of the proxy tell.
TEST_F(ProxyTest, WhenItsServerFreezesAStreamIsCutAndGoesOnWithTheOther) {
  auto stream = Open(kPatience);
  ASSERT_TRUE(stream) << stream.error().message;
  const std::vector<Complex> shape = Drag(*stream, 1, 5);
  ASSERT_FALSE(shape.empty());
  cluster_.Do("freeze", Holder());
  ExpectGoesOn(*stream, shape);
}

}  // namespace
}  // namespace arap::cluster
