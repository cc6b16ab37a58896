// Bytes that no client would send. The server drops who sends them and nobody else.
#include <csignal>

#include <gtest/gtest.h>

#include "tests/support/random.h"
#include "tests/system/fault/bystander.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/limits.h"
#include "tests/system/fault/raw_peer.h"
#include "tests/system/fault/server_process.h"

namespace arap::fault {
namespace {

constexpr const char* kStream = "/arap.v1.DeformationService/StreamDeform";
constexpr const char* kRegister = "/arap.v1.DeformationService/RegisterMesh";

class GarbageTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.Start());
    bystander_.emplace(server_.address());
    ASSERT_TRUE(bystander_->GoesOn());
    descriptors_ = server_.Descriptors();
    memory_ = server_.ResidentBytes();
  }

  // Everybody else goes on, a new client is served, and nothing is left of the bad ones.
  void TearDown() override {
    EXPECT_TRUE(bystander_->GoesOn());
    EXPECT_TRUE(FaultClient(server_.address()).Info().ok());
    EXPECT_TRUE(Eventually([&] { return server_.Descriptors() <= descriptors_; }));
    EXPECT_LT(server_.ResidentBytes(), memory_ + Megabytes(64));
    bystander_->Stop();
    bystander_.reset();
    server_.Signal(SIGTERM);
    EXPECT_EQ(server_.Wait(std::chrono::seconds(30)), 0) << server_.Log();
  }

  std::string Noise(std::size_t length) {
    std::string noise(length, '\0');
    for (char& byte : noise) byte = static_cast<char>(random_.Below(256));
    return noise;
  }

  // How often the server's log says `words`.
  std::size_t Count(const std::string& words) const {
    const std::string log = server_.Log();
    std::size_t count = 0;
    for (std::size_t at = 0; (at = log.find(words, at)) != std::string::npos; ++at) ++count;
    return count;
  }

  ServerProcess server_;
  testing::Random random_{20'26};
  std::optional<Bystander> bystander_;
  std::size_t descriptors_ = 0;
  std::size_t memory_ = 0;
};

TEST_F(GarbageTest, NoiseInsteadOfAPreface) {
  for (int round = 0; round < 100; ++round) {
    RawPeer peer(server_.address());
    peer.Send(Noise(1 + random_.Below(4'096)));
    peer.HalfClose();
    EXPECT_TRUE(peer.IsClosed());
  }
}

TEST_F(GarbageTest, OtherProtocols) {
  for (const char* words : {"GET / HTTP/1.1\r\nHost: a\r\n\r\n", "\x16\x03\x01\x02\x00\x01\x00\x01",
                            "SSH-2.0-OpenSSH_9.2\r\n", "\r\n\r\n"}) {
    RawPeer peer(server_.address());
    peer.Send(words);
    peer.HalfClose();
    EXPECT_TRUE(peer.IsClosed()) << words;
  }
}

TEST_F(GarbageTest, NoiseAfterThePreface) {
  for (int round = 0; round < 100; ++round) {
    RawPeer peer(server_.address());
    peer.Send(http2::Preface() + Noise(1 + random_.Below(4'096)));
    peer.HalfClose();
    EXPECT_TRUE(peer.IsClosed());
  }
}

// Frames whose length is right and whose content is not.
TEST_F(GarbageTest, WellFramedNoise) {
  for (int round = 0; round < 200; ++round) {
    RawPeer peer(server_.address());
    std::string bytes = http2::Preface() + http2::OpenCall(1, kStream);
    for (std::size_t frame = 0; frame < 1 + random_.Below(20); ++frame) {
      bytes +=
          http2::Frame(static_cast<std::uint8_t>(random_.Below(11)),
                       static_cast<std::uint8_t>(random_.Below(256)),
                       static_cast<std::uint32_t>(random_.Below(4)), Noise(random_.Below(200)));
    }
    peer.Send(bytes);
    peer.HalfClose();
    EXPECT_TRUE(peer.IsClosed());
  }
}

// Real calls whose messages are noise: every method gets some.
TEST_F(GarbageTest, MessagesThatDoNotParse) {
  for (const char* method :
       {"DeformationService/CreateSession", "DeformationService/RegisterMesh",
        "DeformationService/CompileHandles", "DeformationService/EditHandles",
        "DeformationService/Deform", "DeformationService/DeformTrack",
        "DeformationService/StreamDeform", "FlatteningService/Flatten",
        "ServerService/GetServerInfo", "ServerService/NoSuchMethod", "NoSuchService/Method"}) {
    RawPeer peer(server_.address());
    std::string bytes = http2::Preface();
    for (std::uint32_t call = 0; call < 20; ++call) {
      const std::uint32_t stream = 2 * call + 1;
      const std::string noise = Noise(random_.Below(300));
      bytes += http2::OpenCall(stream, std::string("/arap.v1.") + method);
      bytes += http2::Message(stream, static_cast<std::uint32_t>(noise.size()), noise);
    }
    EXPECT_TRUE(peer.Send(bytes)) << method;
    // The connection is in order: only its calls were wrong.
    EXPECT_TRUE(peer.Send(http2::Frame(http2::kPing, 0, 0, "12345678"))) << method;
    peer.HalfClose();
    EXPECT_TRUE(peer.IsClosed()) << method;
  }
}

// A message that claims 4 GB and sends a few bytes must not cost 4 GB, nor 4 MB.
TEST_F(GarbageTest, HugeClaimsCostNothing) {
  std::vector<RawPeer> peers;
  for (int i = 0; i < 50; ++i) {
    RawPeer& peer = peers.emplace_back(server_.address());
    std::string bytes = http2::Preface();
    bytes += http2::OpenCall(1, kRegister) + http2::Message(1, 0xFFFF'FFFF, "few");
    bytes += http2::OpenCall(3, kRegister) + http2::Message(3, 60u << 20u, "few");
    bytes += http2::OpenCall(5, kStream) + http2::Message(5, 60u << 20u, "few");
    EXPECT_TRUE(peer.Send(bytes));
  }
  EXPECT_TRUE(bystander_->GoesOn(100));
  EXPECT_LT(server_.ResidentBytes(), memory_ + Megabytes(48));
}

// Calls that are taken back at once, again and again: on each connection fewer than what closes it.
TEST_F(GarbageTest, RapidResets) {
  constexpr std::uint32_t kCalls = 1'000;
  const std::string cancel("\0\0\0\x8", 4);
  for (std::size_t round = 1; round <= 15; ++round) {
    RawPeer peer(server_.address());
    peer.Send(http2::Preface());
    for (std::uint32_t call = 0; call < kCalls; ++call) {
      const std::uint32_t stream = 2 * call + 1;
      ASSERT_TRUE(peer.Send(http2::OpenCall(stream, kStream) +
                            http2::Frame(http2::kResetStream, 0, stream, cancel)));
    }
    EXPECT_TRUE(bystander_->GoesOn());
    // The log has a line for each, once the server has caught up.
    EXPECT_TRUE(Eventually([&] { return Count("rpc=StreamDeform") >= round * kCalls; }));
    // Thousands of calls leave the allocator with memory; more of them must find it enough.
    if (round == 6) memory_ = server_.ResidentBytes();
  }
}

TEST_F(GarbageTest, FloodsOfControlFrames) {
  const std::string setting("\0\x4\0\x1\0\0", 6);
  const std::string increment("\x7F\xFF\xFF\xFF", 4);
  for (const std::string& frame :
       {http2::Frame(http2::kPing, 0, 0, "12345678"), http2::Frame(http2::kSettings, 0, 0, setting),
        http2::Frame(http2::kWindowUpdate, 0, 0, increment),
        http2::Frame(http2::kContinuation, 0, 1, "more"),
        http2::Frame(http2::kHeaders, 0, 1, std::string(16'000, '\0'))}) {
    RawPeer peer(server_.address());
    peer.Send(http2::Preface());
    std::string many;
    for (int i = 0; i < 200; ++i) many += frame;
    for (int i = 0; i < 20 && peer.Send(many); ++i) {
    }
    EXPECT_TRUE(bystander_->GoesOn());
  }
}

class OversizedTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.Start());
    client_.emplace(server_.address());
    client_->SetUp(4);
  }
  ServerProcess server_{{"--max-message-bytes", "100000"}};
  std::optional<FaultClient> client_;
};

TEST_F(OversizedTest, CallsAreRefusedByName) {
  const grpc::Status status = client_->Register("s", "large", wire::Grid(100, 100));
  EXPECT_EQ(status.error_code(), grpc::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_TRUE(
      client_->Deform("s", "h", {wire::TargetAt("a", 0, 0), wire::TargetAt("b", 4, 0)}).ok());
}

TEST_F(OversizedTest, AStreamEndsAndTheOthersOfItsConnectionGoOn) {
  wire::DeformStream other(client_->deformation());
  other.Opened("s", "h", v1::DELIVERY_EVERY);
  wire::DeformStream stream(client_->deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  v1::StreamDeformRequest large;
  large.mutable_update()->set_sequence(1);
  for (int i = 0; i < 50'000; ++i) large.mutable_update()->add_positions(i);
  stream.Send(large);
  EXPECT_FALSE(stream.Read());
  EXPECT_EQ(stream.Finish().error_code(), grpc::RESOURCE_EXHAUSTED);
  other.Update(1, {wire::TargetAt("a", 1, 1)});
  EXPECT_EQ(other.ReadShape().sequence(), 1u);
}

}  // namespace
}  // namespace arap::fault
