// What is made again and what is not, for how long, and under which names.
#include <gmock/gmock.h>

#include "arap/client/client.h"
#include "client/src/calls.h"
#include "tests/support/fake_server.h"

namespace arap::client {
namespace {

using internal::IsFull;
using internal::IsLost;
using std::chrono::milliseconds;
using testing::FakeServer;

const grpc::Status kGone(grpc::StatusCode::UNAVAILABLE, "Socket closed");

// As a server refuses that says when to come again.
grpc::Status Refused(FaultKind kind) { return convert::ToGrpcStatus(Fault(kind, "Not now.")); }

class RetryTest : public ::testing::Test {
 protected:
  RetryTest() {
    EXPECT_TRUE(session_.RegisterMesh({{{0, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}}}, {}, "m"));
    EXPECT_TRUE(session_.CompileHandles("h", "m", handles_));
  }

  FakeServer server_;
  Client client_ = Client::Connect(server_.address());
  Session session_ = client_.AttachSession("s");
  std::vector<Handle> handles_{{"a", VertexAnchor{0}}};
  std::vector<HandleTarget> targets_{{"a", {{1, 2}}}};
};

TEST_F(RetryTest, ALostCallThatMayBeDoneTwiceIsMadeAgain) {
  server_.Refuse("Deform", {kGone, {grpc::StatusCode::INTERNAL, "Received RST_STREAM"}});
  const auto shape = session_.Deform("h", targets_);
  EXPECT_TRUE(shape) << shape.error().message;
  EXPECT_EQ(server_.calls("Deform"), 3);
}

TEST_F(RetryTest, ARefusalThatSaysWhenIsFollowed) {
  server_.Refuse("Deform", {Refused(FaultKind::kOverloaded), Refused(FaultKind::kDraining)});
  EXPECT_TRUE(session_.Deform("h", targets_));
  EXPECT_EQ(server_.calls("Deform"), 3);
}

TEST_F(RetryTest, AnEditIsMadeAgainOnlyWhenItWasNotBegun) {
  server_.Refuse("EditHandles", {kGone});
  const auto lost = session_.EditHandles("h", std::vector<std::string>{"a"}, {});
  ASSERT_FALSE(lost);
  EXPECT_EQ(server_.calls("EditHandles"), 1);
  server_.Refuse("EditHandles", {Refused(FaultKind::kDraining)});
  EXPECT_TRUE(session_.EditHandles("h", std::vector<std::string>{"a"}, {}));
  EXPECT_EQ(server_.calls("EditHandles"), 3);
}

TEST_F(RetryTest, ARemovalWhoseAnswerWasLostIsDone) {
  server_.LoseTheAnswer("DeleteHandleSet", {kGone});
  EXPECT_TRUE(session_.DeleteHandleSet("h"));
  EXPECT_EQ(server_.calls("DeleteHandleSet"), 2);
  const Status again = session_.DeleteHandleSet("h");
  ASSERT_FALSE(again) << "without a doubt";
  EXPECT_EQ(again.error().kind, FaultKind::kNotFound);
}

TEST_F(RetryTest, WhatIsWrongStaysWrong) {
  const Fault bad(FaultKind::kInvalidOption, "refine is too large.");
  server_.Refuse("Deform", {convert::ToGrpcStatus(bad)});
  EXPECT_FALSE(session_.Deform("h", targets_));
  const Fault beyond = Fault(FaultKind::kLimitExceeded, "Too much.").Field("targets");
  server_.Refuse("Deform", {convert::ToGrpcStatus(beyond)});
  EXPECT_FALSE(session_.Deform("h", targets_));
  EXPECT_EQ(server_.calls("Deform"), 2);
}

TEST_F(RetryTest, NothingIsMadeAgainForLongerThanWasSaid) {
  server_.Refuse("GetMesh", std::vector<grpc::Status>(100, kGone));
  const auto once = session_.GetMesh("m", {.retry_within = milliseconds(0)});
  ASSERT_FALSE(once);
  EXPECT_EQ(once.error().kind, FaultKind::kDraining);
  EXPECT_EQ(server_.calls("GetMesh"), 1);
  EXPECT_FALSE(session_.GetMesh("m", {.retry_within = milliseconds(300)}));
  EXPECT_LE(server_.calls("GetMesh"), 10) << "pauses grow from 25 ms at least";
}

TEST_F(RetryTest, TheDeadlineIsThatOfAllAttempts) {
  server_.Hush("GetMesh");
  const auto silent = session_.GetMesh("m", {.timeout = milliseconds(100)});
  ASSERT_FALSE(silent);
  EXPECT_EQ(silent.error().kind, FaultKind::kDeadlineExceeded);
  server_.Refuse("GetMesh", std::vector<grpc::Status>(100, kGone));
  EXPECT_FALSE(session_.GetMesh(
      "m", {.timeout = milliseconds(300), .retry_within = std::chrono::minutes(10)}));
}

TEST_F(RetryTest, StoppingEndsThePauses) {
  server_.Refuse("GetMesh", std::vector<grpc::Status>(100, kGone));
  std::stop_source stop;
  stop.request_stop();
  const auto stopped =
      session_.GetMesh("m", {.stop = stop.get_token(), .retry_within = std::chrono::minutes(10)});
  ASSERT_FALSE(stopped);
}

TEST_F(RetryTest, EveryCallHasALimitUnlessItIsTold) {
  using internal::DeadlineOf;
  const auto now = std::chrono::system_clock::now();
  const auto quick = DeadlineOf({}, kQuickLimit);
  ASSERT_TRUE(quick);
  EXPECT_GE(*quick, now + kQuickLimit);
  EXPECT_FALSE(DeadlineOf({.timeout = kNoLimit}, kQuickLimit));
  EXPECT_LE(*DeadlineOf({.timeout = milliseconds(1)}, kQuickLimit), now + std::chrono::seconds(20));
}

TEST_F(RetryTest, ACallHasOneNameInAllItsAttempts) {
  constexpr const char* kTrace = "00-0af7651916cd43dd8448eb211c80319c-b7ad6b7169203331-01";
  ASSERT_TRUE(session_.GetMesh("m", {.traceparent = kTrace}));
  EXPECT_EQ(server_.header("GetMesh", "traceparent"), kTrace);
  EXPECT_EQ(server_.header("GetMesh", "x-session-id"), "s");
  ASSERT_TRUE(session_.GetMesh("m", {.traceparent = "none\n"}));
  const std::string own = server_.header("GetMesh", "traceparent");
  EXPECT_EQ(own.size(), std::string(kTrace).size());
  EXPECT_NE(own, kTrace);
  const auto missing = session_.GetMesh("other");
  ASSERT_FALSE(missing);
  const std::string id = server_.header("GetMesh", "x-request-id");
  EXPECT_EQ(id.size(), 32u);
  EXPECT_EQ(DetailOf(missing.error(), kRequestIdDetail), id);
}

TEST_F(RetryTest, AnIdThatNoHeaderCarriesIsTheServersToRefuse) {
  EXPECT_FALSE(client_.AttachSession("two\nlines").GetMesh("m"));
  EXPECT_EQ(server_.header("GetMesh", "x-session-id"), "");
}

TEST(Backoff, GrowsAndIsNeverTheSameForAll) {
  internal::Backoff backoff;
  milliseconds most{50};
  for (int i = 0; i < 10; ++i, most = std::min(2 * most, milliseconds(2'000))) {
    const milliseconds pause = backoff.Next();
    EXPECT_GE(pause, most / 2);
    EXPECT_LE(pause, most);
  }
}

TEST(Lost, IsWhatTheServersEndLooksLikeAlsoBehindProxies) {
  using enum grpc::StatusCode;
  EXPECT_TRUE(IsLost({UNAVAILABLE, "Socket closed"}));
  EXPECT_TRUE(IsLost({UNKNOWN, "No status received"}));
  EXPECT_TRUE(IsLost({UNKNOWN, "Stream removed"}));
  EXPECT_TRUE(IsLost({INTERNAL, "Received RST_STREAM with error code 2"}));
  EXPECT_TRUE(IsLost({CANCELLED, "Received RST_STREAM with error code 8"}));
  EXPECT_FALSE(IsLost({UNKNOWN, "something else"}));
  EXPECT_FALSE(IsLost({INTERNAL, "a bug"}));
  EXPECT_TRUE(IsLost({CANCELLED, "CANCELLED"}));
  EXPECT_FALSE(IsLost({NOT_FOUND, ""}));
  EXPECT_FALSE(IsLost(grpc::Status::OK));
}

TEST(Full, IsWhatMayFindRoomLater) {
  const auto coded = [](const char* code) {
    return Fault(FaultKind::kInternal, "").Detail(std::string(kGrpcCodeDetail), code);
  };
  EXPECT_TRUE(IsFull(coded("RESOURCE_EXHAUSTED")));
  EXPECT_FALSE(IsFull(coded("NOT_FOUND")));
}

}  // namespace
}  // namespace arap::client
