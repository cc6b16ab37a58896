// Before anybody has said who they are: what connections, headers and half a request may cost.
#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include "tests/system/fault/client.h"
#include "tests/system/fault/limits.h"
#include "tests/system/fault/raw_peer.h"
#include "tests/system/fault/server_process.h"
#include "tests/system/wire/http_get.h"
#include "tests/system/wire/token_fixture.h"

namespace arap::fault {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;

constexpr seconds kPatience{20};
constexpr const char* kRegister = "/arap.v1.DeformationService/RegisterMesh";
constexpr const char* kAll[] = {"/arap.v1.DeformationService/CreateSession",
                                "/arap.v1.DeformationService/GetSession",
                                "/arap.v1.DeformationService/ListSessions",
                                "/arap.v1.DeformationService/DeleteSession",
                                kRegister,
                                "/arap.v1.DeformationService/GetMesh",
                                "/arap.v1.DeformationService/DeleteMesh",
                                "/arap.v1.DeformationService/CompileHandles",
                                "/arap.v1.DeformationService/EditHandles",
                                "/arap.v1.DeformationService/GetHandleSet",
                                "/arap.v1.DeformationService/DeleteHandleSet",
                                "/arap.v1.DeformationService/Deform",
                                "/arap.v1.DeformationService/DeformTrack",
                                "/arap.v1.DeformationService/StreamDeform",
                                "/arap.v1.FlatteningService/Flatten",
                                "/arap.v1.ServerService/GetServerInfo",
                                "/grpc.health.v1.Health/Check",
                                "/grpc.health.v1.Health/Watch"};

// The most memory that the process ever had.
std::size_t PeakBytes(const ChildProcess& process) {
  std::ifstream status("/proc/" + std::to_string(process.pid()) + "/status");
  std::size_t kilobytes = 0;
  for (std::string word; status >> word;) {
    if (word == "VmHWM:") status >> kilobytes;
  }
  return kilobytes * 1024;
}

// The value of a metric without labels; -1 when it is not served.
double Metric(const std::string& admin, const std::string& name) {
  const std::string text = wire::HttpGet(admin, "/metrics").body;
  const std::size_t at = text.find("\n" + name + " ");
  return at == std::string::npos ? -1 : std::stod(text.substr(at + name.size() + 2));
}

// One call with a message of zeros, compressed.
grpc::Status CallCompressed(grpc::GenericStub& stub, const std::string& path,
                            grpc_compression_algorithm how, std::size_t bytes) {
  const std::string zeros(bytes, '\0');
  const grpc::Slice slice(zeros);
  const grpc::ByteBuffer message(&slice, 1);
  grpc::ByteBuffer answer;
  grpc::Status status;
  grpc::ClientContext context;
  SetDeadline(context);
  context.set_compression_algorithm(how);
  grpc::CompletionQueue queue;
  const auto call = stub.PrepareUnaryCall(&context, path, message, &queue);
  call->StartCall();
  call->Finish(&answer, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  return status;
}

TEST(DoorTest, CompressedRequestsAreRefusedAndNeverInflated) {
  ServerProcess server;
  ASSERT_TRUE(server.Start());
  grpc::GenericStub stub(grpc::CreateChannel(server.address(), grpc::InsecureChannelCredentials()));
  ASSERT_TRUE(FaultClient(server.address()).Info().ok());
  const std::size_t before = PeakBytes(server);
  for (const auto how : {GRPC_COMPRESS_GZIP, GRPC_COMPRESS_DEFLATE}) {
    for (const char* path : kAll) {
      const grpc::Status refused = CallCompressed(stub, path, how, 1'024);
      EXPECT_EQ(refused.error_code(), grpc::UNIMPLEMENTED) << path;
      EXPECT_THAT(refused.error_message(), HasSubstr("ompression")) << path;
    }
    // 100 MB in 100 kB.
    EXPECT_FALSE(CallCompressed(stub, kRegister, how, 100'000'000).ok());
  }
  EXPECT_LT(PeakBytes(server), before + Megabytes(32));
  EXPECT_TRUE(FaultClient(server.address()).Info().ok());
}

TEST(DoorTest, NobodyIsListenedToBeforeTheirNameIsKnown) {
  const wire::SecretFolder secrets;
  secrets.PutTokens({wire::TestToken('a', "alice").Entry()});
  ServerProcess server({"--token-file", secrets.tokens(), "--log-level", "debug"});
  ASSERT_TRUE(server.Start());
  RawPeer peer(server.address());
  ASSERT_TRUE(peer.Send(http2::Preface()));
  std::uint32_t stream = 1;
  for (const char* path : kAll) {
    if (std::string_view(path).find("/arap.v1.Server") == 0 ||
        std::string_view(path).find("/grpc") == 0) {
      continue;
    }
    // Headers alone: no message, and no end of the request.
    ASSERT_TRUE(peer.Send(http2::OpenCall(stream, path)));
    stream += 2;
    const std::string name =
        std::string_view(path).substr(std::string_view(path).rfind('/') + 1).data();
    EXPECT_TRUE(Eventually([&] {
      return server.Log().find("rpc=" + name + " owner=- session=- code=UNAUTHENTICATED") !=
             std::string::npos;
    })) << path;
  }
}

// Whoever goes on calling after being refused is let go, without harm to others of the address.
TEST(DoorTest, StrangersWhoGoOnAndOnAreCut) {
  const wire::SecretFolder secrets;
  const wire::TestToken alice('a', "alice");
  secrets.PutTokens({alice.Entry()});
  for (const char* path :
       {kRegister, "/arap.v1.DeformationService/StreamDeform",
        "/arap.v1.DeformationService/DeformTrack", "/arap.v1.ServerService/GetServerInfo",
        "/grpc.health.v1.Health/Watch", "/no/method"}) {
    SCOPED_TRACE(path);
    ServerProcess server({"--token-file", secrets.tokens()});
    ASSERT_TRUE(server.Start());
    const std::string admin = server.ReadLine("arapd admin on ", kPatience).value_or("");
    FaultClient early(server.address(), alice.Text());
    ASSERT_TRUE(early.CreateSession("s").ok());
    RawPeer peer(server.address());
    ASSERT_TRUE(peer.Send(http2::Preface()));
    for (std::uint32_t stream = 1; stream < 2'000; stream += 2) {
      if (!peer.Send(http2::OpenCall(stream, path))) break;
    }
    EXPECT_TRUE(peer.IsClosed());
    EXPECT_EQ(Metric(admin, "arapd_connections_cut_total"), 1);
    EXPECT_TRUE(early.CreateSession("t").ok());
    FaultClient late(server.address(), alice.Text());
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(late.CreateSession("u").ok());
    EXPECT_TRUE(FaultClient(server.address()).Info().ok());
    EXPECT_EQ(wire::HttpGet(admin, "/readyz").status, 200);
  }
}

// What gRPC answers itself, before we hear of a call, counts by its bytes.
TEST(DoorTest, StrangersWhoSayNothingThatWeHearAreCut) {
  ServerProcess server;
  ASSERT_TRUE(server.Start());
  RawPeer peer(server.address());
  ASSERT_TRUE(peer.Send(http2::Preface()));
  const std::string nothing = http2::Frame(http2::kWindowUpdate, 0, 0, std::string("\0\0\0\1", 4));
  std::string many;
  for (int i = 0; i < 1'000; ++i) many += nothing;
  for (int i = 0; i < 100 && peer.Send(many); ++i) {
  }
  EXPECT_TRUE(peer.IsClosed());
}

TEST(DoorTest, ARequestThatDoesNotArriveEnds) {
  ServerProcess server({"--receiving-seconds", "0.2"});
  ASSERT_TRUE(server.Start());
  RawPeer peer(server.address());
  ASSERT_TRUE(peer.Send(http2::Preface()));
  ASSERT_TRUE(peer.Send(http2::OpenCall(1, kRegister)));
  ASSERT_TRUE(peer.Send(http2::Message(1, 1'000'000, "all but the rest")));
  ASSERT_TRUE(peer.Send(http2::OpenCall(3, "/grpc.health.v1.Health/Watch")));
  EXPECT_TRUE(Eventually([&] {
    return server.Log().find("rpc=RegisterMesh owner=anonymous session=- code=DEADLINE_EXCEEDED") !=
           std::string::npos;
  }));
}

TEST(DoorTest, WhoeverHoldsTheMostOfHalfRequestsIsCut) {
  ServerProcess server({"--max-receiving-bytes", "50000"});
  ASSERT_TRUE(server.Start());
  const std::string admin = server.ReadLine("arapd admin on ", kPatience).value_or("");
  FaultClient bystander(server.address());
  ASSERT_TRUE(bystander.CreateSession("s").ok());
  RawPeer small(server.address());
  RawPeer large(server.address());
  for (RawPeer* peer : {&small, &large}) {
    ASSERT_TRUE(peer->Send(http2::Preface()));
    ASSERT_TRUE(peer->Send(http2::OpenCall(1, kRegister)));
  }
  // As much as may be sent before the server makes more room.
  ASSERT_TRUE(small.Send(http2::Message(1, 40'000'000, std::string(10'000, 'x'))));
  ASSERT_TRUE(large.Send(http2::Message(1, 40'000'000, std::string(15'000, 'x'))));
  const std::string piece = http2::Frame(http2::kData, 0, 1, std::string(15'000, 'x'));
  for (int i = 0; i < 3; ++i) large.Send(piece);
  EXPECT_TRUE(large.IsClosed());
  EXPECT_TRUE(bystander.CreateSession("t").ok());
  EXPECT_EQ(Metric(admin, "arapd_connections_cut_total"), 1);
  EXPECT_EQ(Metric(admin, "arapd_connections"), 2);
}

TEST(DoorTest, SilentConnectionsMakeRoomForThoseThatCall) {
  ServerProcess server({"--max-connections", "60", "--max-connections-per-address", "40"});
  ASSERT_TRUE(server.Start());
  const std::string admin = server.ReadLine("arapd admin on ", kPatience).value_or("");
  FaultClient early(server.address());
  ASSERT_TRUE(early.CreateSession("early").ok());
  const std::size_t before = server.Descriptors();
  std::vector<RawPeer> silent;
  for (int i = 0; i < 300; ++i) silent.emplace_back(server.address());
  EXPECT_TRUE(early.CreateSession("still").ok());
  EXPECT_TRUE(FaultClient(server.address()).CreateSession("late").ok());
  EXPECT_TRUE(Eventually([&] { return server.Descriptors() <= before + 60; }));
  EXPECT_EQ(wire::HttpGet(admin, "/readyz").status, 200);
  EXPECT_TRUE(silent.front().IsClosed());
}

// As many as there are descriptors for: the listener lives.
TEST(DoorTest, DescriptorsThatRunOutLeaveNobodyDeaf) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP()
      << "The sanitizer takes descriptors itself, to look at an object's class, and takes it "
         "for a broken one without.";
#endif
  ServerProcess server;
  server.Under({"/usr/bin/prlimit", "--nofile=200:200"});
  ASSERT_TRUE(server.Start());
  const std::string admin = server.ReadLine("arapd admin on ", kPatience).value_or("");
  for (int round = 0; round < 2; ++round) {
    std::vector<RawPeer> silent;
    for (int i = 0; i < 400; ++i) silent.emplace_back(server.address());
    EXPECT_TRUE(FaultClient(server.address()).Info().ok());
  }
  EXPECT_TRUE(FaultClient(server.address()).Info().ok());
  EXPECT_EQ(wire::HttpGet(admin, "/readyz").status, 200);
}

TEST(DoorTest, SlowReadersOfTheAdminPageAreInNobodysWay) {
  ServerProcess server;
  ASSERT_TRUE(server.Start());
  const std::string admin = server.ReadLine("arapd admin on ", kPatience).value_or("");
  std::vector<RawPeer> slow;
  for (int i = 0; i < 200; ++i) {
    slow.emplace_back(admin);
    slow.back().Send("GET /metr");
  }
  for (int i = 0; i < 20; ++i) EXPECT_EQ(wire::HttpGet(admin, "/readyz").status, 200);
  // And they are let go, in seconds.
  EXPECT_TRUE(slow.back().IsClosed());
}

TEST(DoorTest, WatchersOfHealthAreCounted) {
  ServerProcess server({"--drain-seconds", "0.5"});
  ASSERT_TRUE(server.Start());
  const std::size_t before = server.ResidentBytes();
  std::vector<RawPeer> peers;
  for (int i = 0; i < 10; ++i) {
    RawPeer& peer = peers.emplace_back(server.address());
    ASSERT_TRUE(peer.Send(http2::Preface()));
    for (std::uint32_t stream = 1; stream < 200; stream += 2) {
      ASSERT_TRUE(peer.Send(http2::OpenCall(stream, "/grpc.health.v1.Health/Watch")));
      ASSERT_TRUE(peer.Send(http2::Message(stream, 0, "")));
    }
  }
  EXPECT_TRUE(FaultClient(server.address()).Info().ok());
  EXPECT_LT(server.ResidentBytes(), before + Megabytes(32));
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(seconds(5)), 0);
}

// Streams that are reset as soon as they are open: HTTP/2 does not count them.
TEST(DoorTest, CallsThatAreResetAtOnceAreNotKept) {
  ServerProcess server;
  ASSERT_TRUE(server.Start());
  const std::size_t before = server.ResidentBytes();
  const std::string cancel("\0\0\0\x08", 4);
  for (const char* path : {kRegister, "/arap.v1.ServerService/GetServerInfo", "/no/method"}) {
    RawPeer peer(server.address());
    ASSERT_TRUE(peer.Send(http2::Preface()));
    bool open = true;
    for (std::uint32_t stream = 1; open && stream < 60'000; stream += 2) {
      open = peer.Send(http2::OpenCall(stream, path)) &&
             peer.Send(http2::Frame(http2::kResetStream, 0, stream, cancel));
    }
    EXPECT_TRUE(FaultClient(server.address()).Info().ok());
    EXPECT_LT(PeakBytes(server), before + Megabytes(192)) << path;
  }
}

TEST(DoorTest, TheEndHasABoundWhateverHoldsItUp) {
  ServerProcess server({"--drain-seconds", "0.1"});
  ASSERT_TRUE(server.Start());
  FaultClient client(server.address());
  // One factorisation of half a minute, which looks at no deadline.
  ASSERT_TRUE(client.CreateSession("s").ok());
  std::thread upload([&] { client.Register("s", "m", wire::Grid(700, 700)); });
  EXPECT_TRUE(Eventually([&] { return server.ResidentBytes() > Megabytes(200); }));
  server.Signal(SIGTERM);
  EXPECT_EQ(server.Wait(seconds(10)), 0);
  upload.join();
}

}  // namespace
}  // namespace arap::fault
