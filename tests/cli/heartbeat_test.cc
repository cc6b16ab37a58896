// Streams of the client library on servers that are silent, slow, full or broken.
#include <atomic>
#include <future>
#include <mutex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "arap/client/client.h"
#include "tests/cli/scripted_server.h"

namespace arap::cli {
namespace {

using client::DeformStream;
using client::StreamEvent;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;
using Stream = ScriptedServer::Stream;
using Request = ScriptedServer::Request;

constexpr seconds kPatience{30};

client::StreamOptions Quick(milliseconds silence, milliseconds resume_within = {}) {
  client::StreamOptions options;
  options.delivery = client::Delivery::kEvery;
  options.heartbeat = milliseconds(50);
  options.silence = silence;
  options.resume_within = resume_within;
  return options;
}

Result<DeformStream> Open(const std::string& address, const client::StreamOptions& options) {
  return client::Client::Connect(address).AttachSession("s").OpenStream("h", options,
                                                                        {.timeout = kPatience});
}

// The next event, which has to be a T.
template <class T>
T Next(DeformStream& stream) {
  Result<std::optional<StreamEvent>> event = stream.Read();
  if (!event || !*event || !std::holds_alternative<T>(**event)) {
    ADD_FAILURE() << (event ? "another event" : event.error().message);
    return {};
  }
  return std::get<T>(**std::move(event));
}

// An error of ours, long before the deadline.
void ExpectSilence(const Fault& fault) {
  EXPECT_EQ(fault.kind, FaultKind::kDraining) << fault.message;
  EXPECT_THAT(fault.message, HasSubstr("Nothing was heard from the server"));
}

// A peer that takes connections, in the kernel, and never says a word.
class Listener {
 public:
  Listener() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const generic = reinterpret_cast<sockaddr*>(&address);
    EXPECT_EQ(::bind(socket_, generic, size), 0);
    EXPECT_EQ(::listen(socket_, 8), 0);
    EXPECT_EQ(::getsockname(socket_, generic, &size), 0);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  }
  ~Listener() { ::close(socket_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  const std::string& address() const { return address_; }

 private:
  const int socket_;
  std::string address_;
};

TEST(SilenceTest, APeerThatSaysNothingIsNotWaitedFor) {
  const Listener peer;
  const auto stream = Open(peer.address(), Quick(milliseconds(200)));
  ASSERT_FALSE(stream);
  ExpectSilence(stream.error());
}

TEST(SilenceTest, AServerThatOnlyReadsIsGivenUp) {
  ScriptedServer server([](auto&, Stream& stream) {
    ScriptedServer::Ignore(stream);
    return grpc::Status::OK;
  });
  const auto stream = Open(server.address(), Quick(milliseconds(200)));
  ASSERT_FALSE(stream);
  ExpectSilence(stream.error());
}

TEST(SilenceTest, AnOpenStreamThatFallsSilentIsGivenUp) {
  ScriptedServer server([](auto&, Stream& stream) {
    ScriptedServer::Open(stream);
    ScriptedServer::Ignore(stream);
    return grpc::Status::OK;
  });
  auto stream = Open(server.address(), Quick(seconds(1)));
  ASSERT_TRUE(stream) << stream.error().message;
  const auto event = stream->Read();
  ASSERT_FALSE(event);
  ExpectSilence(event.error());
}

// What was evicted, or is on a server that has just started, takes its time.
TEST(SilenceTest, AServerThatIsLongInOpeningIsNotGivenUp) {
  constexpr milliseconds kSilence{1'000};
  ScriptedServer server([&](auto&, Stream& stream) {
    Request request;
    stream.Read(&request);
    const auto begun = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begun < 2 * kSilence && stream.Read(&request)) {
      ScriptedServer::Pong(stream, request);
    }
    ScriptedServer::Open(stream);
    ScriptedServer::Serve(stream);
    return grpc::Status::OK;
  });
  auto stream = Open(server.address(), Quick(kSilence));
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(stream->Ping(7));
  EXPECT_EQ(Next<client::Pong>(*stream).nonce, 7u) << "ours are not shown";
}

TEST(HeartbeatTest, GoesOnWhileNobodyReads) {
  std::promise<void> asked;  // several times
  ScriptedServer server([&](auto&, Stream& stream) {
    ScriptedServer::Open(stream);
    int pings = 0;
    for (Request request; stream.Read(&request);) {
      if (!request.has_ping()) continue;
      ScriptedServer::Pong(stream, request);
      if (++pings == 4) asked.set_value();
    }
    return grpc::Status::OK;
  });
  auto stream = Open(server.address(), Quick(kPatience));
  ASSERT_TRUE(stream) << stream.error().message;
  EXPECT_EQ(asked.get_future().wait_for(kPatience), std::future_status::ready);
  ASSERT_TRUE(stream->Ping(7));
  EXPECT_EQ(Next<client::Pong>(*stream).nonce, 7u) << "ours are not shown";
}

// As when a router forgets a connection: nobody is told, and it stays silent for ever.
TEST(ResumeOnTest, AConnectionOfItsOwnAfterSilence) {
  std::mutex mutex;
  std::set<std::string> dead;  // the client's ends of connections
  ScriptedServer server([&](grpc::ServerContext& context, Stream& stream) {
    const auto is_dead = [&] {
      const std::lock_guard lock(mutex);
      return dead.contains(context.peer());
    };
    for (Request request; !is_dead() && stream.Read(&request);) {
      const std::lock_guard lock(mutex);
      if (request.has_open()) ScriptedServer::Open(stream);
      if (request.has_ping()) ScriptedServer::Pong(stream, request);
      if (!request.has_update()) continue;
      if (dead.empty()) {
        dead.insert(context.peer());
      } else {
        ScriptedServer::Shape(stream, request);
      }
    }
    ScriptedServer::Ignore(stream);
    return grpc::Status::OK;
  });
  auto stream = Open(server.address(), Quick(seconds(1), kPatience));
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(stream->Send({1, {{"a", {{1, 2}}}}, {}, {}}));
  EXPECT_GE(Next<client::Resumed>(*stream).attempts, 1u);
  EXPECT_EQ(Next<client::Shape>(*stream).sequence, 1u);
}

// The job lane of a server that everybody has just come back to is soon full.
TEST(ResumeOnTest, AFullServerIsAskedAgain) {
  std::atomic<int> calls = 0;
  ScriptedServer server([&](auto&, Stream& stream) {
    const int call = calls++;
    for (Request request; stream.Read(&request);) {
      if (request.has_open()) ScriptedServer::Open(stream);
      if (request.has_ping()) ScriptedServer::Pong(stream, request);
      if (request.has_edit() && (call == 1 || call == 2)) {
        ScriptedServer::Error(stream, request, grpc::RESOURCE_EXHAUSTED);
      } else if (request.has_edit() || (request.has_update() && call > 0)) {
        ScriptedServer::Shape(stream, request);
      } else if (request.has_update()) {
        return grpc::Status(grpc::UNAVAILABLE, "going away");
      }
    }
    return grpc::Status::OK;
  });
  auto stream = Open(server.address(), Quick(kPatience, kPatience));
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(stream->Edit(1, std::vector<std::string>{"b"}, {}));
  EXPECT_EQ(Next<client::Shape>(*stream).sequence, 1u);
  ASSERT_TRUE(stream->Send({2, {{"a", {{1, 2}}}}, {}, {}}));
  Next<client::Resumed>(*stream);
  Next<client::Resumed>(*stream);
  Next<client::Resumed>(*stream);
  EXPECT_EQ(Next<client::Shape>(*stream).sequence, 2u);
  EXPECT_EQ(calls, 4);
}

// It opens, and what is said again brings it down: not for ever.
TEST(ResumeOnTest, AServerThatIsLostEachTimeIsGivenUp) {
  std::atomic<int> calls = 0;
  ScriptedServer server([&](auto&, Stream& stream) {
    ++calls;
    for (Request request; stream.Read(&request) && !request.has_update();) {
      if (request.has_open()) ScriptedServer::Open(stream);
      if (request.has_ping()) ScriptedServer::Pong(stream, request);
    }
    return grpc::Status(grpc::UNAVAILABLE, "Socket closed");
  });
  auto stream = Open(server.address(), Quick(kPatience, milliseconds(500)));
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(stream->Send({1, {{"a", {{1, 2}}}}, {}, {}}));
  auto event = stream->Read();
  while (event && *event) event = stream->Read();
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, FaultKind::kDraining) << event.error().message;
  EXPECT_GE(calls, 2);
  EXPECT_LE(calls, 20) << "pauses grow from 25 ms at least";
}

TEST(ResumeOnTest, SequencesHaveToGrow) {
  ScriptedServer server([](auto&, Stream& stream) {
    ScriptedServer::Serve(stream);
    return grpc::Status::OK;
  });
  auto stream = Open(server.address(), Quick(kPatience, kPatience));
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(stream->Send({0, {{"a", {{1, 2}}}}, {}, {}}));
  EXPECT_EQ(Next<client::Shape>(*stream).sequence, 0u);
  const Status again = stream->Send({0, {{"a", {{1, 3}}}}, {}, {}});
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, FaultKind::kInvalidOption);
  EXPECT_EQ(again.error().field, "sequence");
  ASSERT_TRUE(stream->Send({1, {{"a", {{1, 3}}}}, {}, {}}));
  EXPECT_EQ(Next<client::Shape>(*stream).sequence, 1u);
}

}  // namespace
}  // namespace arap::cli
