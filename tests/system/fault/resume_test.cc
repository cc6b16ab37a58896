// Streams of the client library that outlive their server.
#include <csignal>
#include <future>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arap/client/client.h"
#include "client/cli/sample/samples.h"
#include "tests/system/fault/server_process.h"

namespace arap::client {

// GoogleTest finds it by its name.
static void PrintTo(Delivery delivery, std::ostream* out) {
  *out << (delivery == Delivery::kLatest ? "latest" : "every");
}

}  // namespace arap::client

namespace arap::fault {
namespace {

using client::DeformStream;
using client::Delivery;
using client::StreamEvent;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

class ResumeTest : public ::testing::TestWithParam<Delivery> {
 protected:
  void Start(std::vector<std::string> flags = {}) {
    flags.insert(flags.end(), {"--store", "sqlite:{}/state", "--max-stream-idle-seconds", "1"});
    server_.emplace(flags, "unix:{}/socket");
    ASSERT_TRUE(server_->Start());
    session_ = client::Client::Connect(server_->address()).CreateSession();
    ASSERT_TRUE(session_) << session_.error().message;
    ASSERT_TRUE(session_->RegisterMesh(cli::MakeGrid(9, 9), {}, "m"));
    const std::vector<client::Handle> handles{{"l", client::VertexAnchor{0}},
                                              {"r", client::VertexAnchor{8}}};
    ASSERT_TRUE(session_->CompileHandles("h", "m", handles));
  }

  Result<DeformStream> Open(client::StreamOptions options) {
    options.shape.float64 = true;
    return session_->OpenStream("h", options, {.timeout = seconds(60)});
  }
  client::StreamOptions Resuming(milliseconds within = seconds(30)) {
    client::StreamOptions options;
    options.delivery = GetParam();
    options.resume_within = within;
    return options;
  }

  // The next event, which has to be a T.
  template <class T>
  static T Next(DeformStream& stream) {
    Result<std::optional<StreamEvent>> event = stream.Read();
    if (!event || !*event || !std::holds_alternative<T>(**event)) {
      ADD_FAILURE() << (event ? "another event" : event.error().message);
      return {};
    }
    return std::get<T>(**std::move(event));
  }

  // Two updates with an edit of the stream's own between them: what it adds starts where the first
  // has brought it.
  static void Begin(DeformStream& stream) {
    ASSERT_TRUE(stream.Send({1, {{"r", {{8, 3}}}}, {}, {}}));
    EXPECT_EQ(Next<client::Shape>(stream).sequence, 1u);
    const std::vector<client::Handle> top{{"t", client::VertexAnchor{76}}};
    ASSERT_TRUE(stream.Edit(2, {}, top));
    EXPECT_EQ(Next<client::Shape>(stream).sequence, 2u);
    ASSERT_TRUE(stream.Send({3, {{"l", {{-1, 0}}}}, {}, {}}));
    EXPECT_EQ(Next<client::Shape>(stream).sequence, 3u);
  }
  static client::Shape End(DeformStream& stream) {
    EXPECT_TRUE(stream.Send({4, {{"r", {{9, 1}}}}, {}, {}}));
    return Next<client::Shape>(stream);
  }
  // Of a stream that nothing happens to.
  client::Shape Undisturbed() {
    auto stream = Open({.delivery = GetParam()});
    if (!stream) {
      ADD_FAILURE() << stream.error().message;
      return {};
    }
    Begin(*stream);
    return End(*stream);
  }

  std::optional<ServerProcess> server_;
  Result<client::Session> session_ = Fail(FaultKind::kInternal, "not yet");
};

INSTANTIATE_TEST_SUITE_P(Deliveries, ResumeTest,
                         ::testing::Values(Delivery::kLatest, Delivery::kEvery),
                         [](const auto& tested) {
                           return tested.param == Delivery::kLatest ? "Latest" : "Every";
                         });

TEST_P(ResumeTest, AfterAKillTheShapesAreThoseOfAnUndisturbedStream) {
  Start();
  const client::Shape expected = Undisturbed();
  auto stream = Open(Resuming());
  ASSERT_TRUE(stream) << stream.error().message;
  Begin(*stream);
  server_->Kill();
  // Into the void: the reader has not noticed yet.
  ASSERT_TRUE(stream->Send({4, {{"r", {{9, 1}}}}, {}, {}}));
  ASSERT_TRUE(stream->Ping(77));
  ASSERT_TRUE(server_->Start());
  const auto resumed = Next<client::Resumed>(*stream);
  EXPECT_EQ(resumed.handle_set.handles.size(), 2u) << "before the stream's own edit";
  EXPECT_GE(resumed.attempts, 1u);
  client::Shape shape;
  bool pong = false;
  for (int event = 0; event < 2; ++event) {
    auto next = stream->Read();
    ASSERT_TRUE(next && *next) << next.error().message;
    if (const auto* answer = std::get_if<client::Pong>(&**next)) {
      pong = answer->nonce == 77;
    } else {
      shape = std::get<client::Shape>(**next);
    }
  }
  EXPECT_TRUE(pong);
  EXPECT_EQ(shape.sequence, 4u);
  EXPECT_EQ(shape.positions, expected.positions);
  EXPECT_EQ(shape.handle_set_revision, expected.handle_set_revision);
  // And on.
  ASSERT_TRUE(stream->Send({5, {{"t", {{4, 9}}}}, {}, {}}));
  EXPECT_EQ(Next<client::Shape>(*stream).sequence, 5u);
  ASSERT_TRUE(stream->CloseSending());
  const auto end = stream->Read();
  EXPECT_TRUE(end && !*end);
}

TEST_P(ResumeTest, AfterADrainToo) {
  Start();
  const client::Shape expected = Undisturbed();
  auto stream = Open(Resuming());
  ASSERT_TRUE(stream) << stream.error().message;
  Begin(*stream);
  auto resumed = std::async([&] { return Next<client::Resumed>(*stream); });
  server_->Signal(SIGTERM);
  EXPECT_EQ(server_->Wait(seconds(30)), 0);
  ASSERT_TRUE(server_->Start());
  EXPECT_GE(resumed.get().attempts, 1u);
  EXPECT_EQ(End(*stream).positions, expected.positions);
}

TEST_P(ResumeTest, EncodingAndVerticesAreAskedForAgain) {
  Start();
  client::StreamOptions options = Resuming();
  options.shape.encoding = client::PositionEncoding::kInt16Le;
  options.shape.boundary_only = true;
  auto stream = session_->OpenStream("h", options, {.timeout = seconds(60)});
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(stream->Send({1, {{"r", {{8, 3}}}}, {}, {}}));
  const auto before = Next<client::Shape>(*stream);
  EXPECT_EQ(before.vertices.size(), 32u);
  server_->Kill();
  ASSERT_TRUE(server_->Start());
  EXPECT_GE(Next<client::Resumed>(*stream).attempts, 1u);
  ASSERT_TRUE(stream->Send({2, {{"r", {{8, 3}}}}, {}, {}}));
  const auto after = Next<client::Shape>(*stream);
  EXPECT_EQ(after.vertices, before.vertices);
  EXPECT_EQ(after.positions, before.positions);
  EXPECT_EQ(after.position_error, before.position_error);
}

TEST_P(ResumeTest, GivesUpInTime) {
  Start();
  auto stream = Open(Resuming(milliseconds(300)));
  ASSERT_TRUE(stream) << stream.error().message;
  server_->Kill();
  for (int read = 0; read < 2; ++read) {
    const auto lost = stream->Read();
    ASSERT_FALSE(lost);
    EXPECT_EQ(lost.error().kind, FaultKind::kDraining) << lost.error().message;
  }
  EXPECT_FALSE(stream->Send({1, {}, {}, {}}));
}

TEST_P(ResumeTest, CancelEndsTheTrying) {
  Start();
  auto stream = Open(Resuming());
  ASSERT_TRUE(stream) << stream.error().message;
  server_->Kill();
  auto end = std::async([&] { return stream->Read(); });
  stream->Cancel();
  const auto event = end.get();
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, FaultKind::kCancelled) << event.error().message;
}

TEST_P(ResumeTest, WhatIsGoneIsNotTriedAgain) {
  Start();
  auto stream = Open(Resuming());
  ASSERT_TRUE(stream) << stream.error().message;
  ASSERT_TRUE(session_->Delete());
  const auto end = stream->Read();
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, FaultKind::kNotFound) << end.error().message;
}

TEST_P(ResumeTest, AFrozenServerIsNoticed) {
  Start();
  client::StreamOptions options = Resuming({});
  options.heartbeat = milliseconds(50);
  options.silence = milliseconds(300);
  auto stream = Open(options);
  ASSERT_TRUE(stream) << stream.error().message;
  Begin(*stream);
  server_->Signal(SIGSTOP);
  const auto end = stream->Read();
  server_->Signal(SIGCONT);
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().kind, FaultKind::kDraining);
  EXPECT_THAT(end.error().message, HasSubstr("Nothing was heard from the server for 0.3 s"));
}

class HeartbeatTest : public ResumeTest {};
INSTANTIATE_TEST_SUITE_P(Deliveries, HeartbeatTest, ::testing::Values(Delivery::kLatest),
                         [](const auto&) { return "Latest"; });

TEST_P(HeartbeatTest, KeepsAnIdleStream) {
  Start();
  client::StreamOptions options = Resuming({});
  options.heartbeat = milliseconds(100);
  auto alive = Open(options);
  ASSERT_TRUE(alive) << alive.error().message;
  auto next = std::async([&] { return Next<client::Shape>(*alive); });
  // Two of these one after the other take longer than a stream may say nothing.
  for (int round = 0; round < 2; ++round) {
    auto quiet = session_->OpenStream("h", {.heartbeat = {}}, {.timeout = seconds(60)});
    ASSERT_TRUE(quiet) << quiet.error().message;
    const auto end = quiet->Read();
    ASSERT_FALSE(end);
    EXPECT_EQ(end.error().kind, FaultKind::kStreamIdle) << end.error().message;
  }
  ASSERT_TRUE(alive->Send({1, {{"r", {{8, 3}}}}, {}, {}}));
  EXPECT_EQ(next.get().sequence, 1u) << "and no pong came before";
}

}  // namespace
}  // namespace arap::fault
