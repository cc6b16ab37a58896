// Clients that stop, never read or never close: the others go on, and memory stays bounded.
#include <csignal>

#include <gtest/gtest.h>

#include "tests/system/fault/bystander.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/herd.h"
#include "tests/system/fault/limits.h"
#include "tests/system/fault/raw_peer.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

using std::chrono::seconds;
using std::chrono::steady_clock;

// A shape of it has 30 kB: what is kept of a stream shows.
constexpr int kSize = 60;

class SlowClientTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.Start());
    FaultClient(server_.address()).SetUp(kSize);
  }

  // Looks at the server for as long as `time`; the most memory that it had.
  std::size_t MostMemory(std::chrono::milliseconds time) const {
    std::size_t most = 0;
    const auto until = steady_clock::now() + time;
    EXPECT_TRUE(Eventually([&] {
      most = std::max(most, server_.ResidentBytes());
      return steady_clock::now() >= until;
    }));
    return most;
  }

  // Streams that do harm are let in.
  ServerProcess server_{{"--max-stream-load", "0", "--max-stream-fps", "0"}};
};

TEST_F(SlowClientTest, AStoppedClientDelaysNobodyAndGoesOnLater) {
  ChildProcess client;
  ASSERT_TRUE(client.Launch({STOPPED_CLIENT, server_.address()}, server_.folder() / "client"));
  ASSERT_TRUE(client.ReadLine("shape ", seconds(20)));
  Bystander bystander(server_.address());
  ASSERT_TRUE(bystander.GoesOn());

  client.Signal(SIGSTOP);
  const std::size_t before = server_.ResidentBytes();
  EXPECT_TRUE(bystander.GoesOn(500));
  EXPECT_LT(server_.ResidentBytes(), before + Megabytes(16));

  client.Signal(SIGCONT);
  // Two lines may have been on their way.
  for (int line = 0; line < 4; ++line) EXPECT_TRUE(client.ReadLine("shape ", seconds(20)));
}

TEST_F(SlowClientTest, AClientKilledInMidStreamLeavesNothingBehind) {
  const std::size_t before = server_.Descriptors();
  for (int round = 0; round < 3; ++round) {
    ChildProcess client;
    ASSERT_TRUE(client.Launch({STOPPED_CLIENT, server_.address()}, server_.folder() / "client"));
    ASSERT_TRUE(client.ReadLine("shape ", seconds(20)));
    client.Kill();
  }
  EXPECT_TRUE(Eventually([&] { return server_.Descriptors() <= before; }));
}

TEST_F(SlowClientTest, WhoeverNeverReadsCostsAFrameEach) {
  constexpr std::size_t kStreams = 24;
  Bystander bystander(server_.address());
  ASSERT_TRUE(bystander.GoesOn());
  const std::size_t before = server_.ResidentBytes();
  {
    FaultClient client(server_.address());
    Herd every(client, {Habit::kPush, v1::DELIVERY_EVERY});
    Herd latest(client, {Habit::kPush, v1::DELIVERY_LATEST});
    every.Open(kStreams);
    latest.Open(kStreams);
    EXPECT_LT(MostMemory(seconds(5)), before + Megabytes(96));
    EXPECT_GT(every.updates(), kStreams);
    // What is sent on these is replaced, not kept: the client can send on and on, while the others
    // have to wait.
    EXPECT_TRUE(Eventually([&] { return latest.updates() > 2 * every.updates(); }));
    EXPECT_LT(server_.ResidentBytes(), before + Megabytes(96));
    EXPECT_TRUE(bystander.GoesOn());
    EXPECT_EQ(every.ended() + latest.ended(), 0u);
  }
  EXPECT_TRUE(bystander.GoesOn());
}

TEST_F(SlowClientTest, WhoeverNeverClosesIsCountedAndGoesWithItsConnection) {
  const std::size_t before = server_.Descriptors();
  {
    std::vector<RawPeer> silent;       // connections that say nothing
    std::vector<RawPeer> half_closed;  // and some that have said that they will not
    for (int i = 0; i < 200; ++i) {
      silent.emplace_back(server_.address());
      half_closed.emplace_back(server_.address()).HalfClose();
    }
    FaultClient client(server_.address());
    Herd idle(client, {Habit::kIdle});
    idle.Open(100);
    EXPECT_TRUE(Eventually([&] { return idle.opened() == 100; }));
    Bystander bystander(server_.address());
    EXPECT_TRUE(bystander.GoesOn());
    EXPECT_GE(server_.Descriptors(), before + 200);
  }
  EXPECT_TRUE(Eventually([&] { return server_.Descriptors() <= before; }))
      << server_.Descriptors() << " descriptors, " << before << " before";
}

// The network swallows everything in the middle of a stream, and no side says a word.
TEST_F(SlowClientTest, AHalfOpenPeerHoldsNobodyUp) {
  ChildProcess client;
  ASSERT_TRUE(client.Launch({STOPPED_CLIENT, server_.address()}, server_.folder() / "client"));
  ASSERT_TRUE(client.ReadLine("shape ", seconds(20)));
  client.Signal(SIGSTOP);
  std::vector<RawPeer> peers;
  for (int i = 0; i < 50; ++i) {
    RawPeer& peer = peers.emplace_back(server_.address());
    ASSERT_TRUE(peer.Send(http2::Preface()));
    // A call whose message never ends.
    ASSERT_TRUE(peer.Send(http2::OpenCall(1, "/arap.v1.DeformationService/StreamDeform")));
    ASSERT_TRUE(peer.Send(http2::Message(1, 1000, "and then")));
  }
  Bystander bystander(server_.address());
  EXPECT_TRUE(bystander.GoesOn(200));
  EXPECT_TRUE(FaultClient(server_.address()).CreateSession("new").ok());
}

// A stopped process does not answer HTTP/2's pings, while its kernel goes on acknowledging bytes.
TEST(KeepaliveTest, AHalfOpenPeerIsCutOff) {
  ServerProcess server({"--keepalive-seconds", "1", "--keepalive-timeout-seconds", "1"});
  ASSERT_TRUE(server.Start());
  FaultClient(server.address()).SetUp(kSize);
  ChildProcess client;
  ASSERT_TRUE(client.Launch({STOPPED_CLIENT, server.address()}, server.folder() / "client"));
  ASSERT_TRUE(client.ReadLine("shape ", seconds(20)));
  const auto ended = [&] {
    return server.Log().find("rpc=StreamDeform owner=anonymous session=s code=") !=
           std::string::npos;
  };
  EXPECT_FALSE(ended());
  client.Signal(SIGSTOP);
  EXPECT_TRUE(Eventually(ended));
}

}  // namespace
}  // namespace arap::fault
