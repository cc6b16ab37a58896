// Redis below the real server goes away, freezes and comes back, and two servers share what is in
// it.
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/server/store/redis_server.h"
#include "tests/system/fault/bystander.h"
#include "tests/system/fault/client.h"
#include "tests/system/fault/ledger.h"
#include "tests/system/fault/server_process.h"
#include "tests/system/wire/http_get.h"

namespace arap::fault {
namespace {

using std::chrono::seconds;
using std::chrono::steady_clock;
using Stub = v1::DeformationService::Stub;

constexpr seconds kPatience{30};
const std::vector<std::string> kIds{"a", "b"};

class RedisTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(a_.Start());
    const auto admin = a_.ReadLine("arapd admin on ", kPatience);
    ASSERT_TRUE(admin);
    admin_ = *admin;
    client_.emplace(a_.address());
    ASSERT_NO_FATAL_FAILURE(client_->SetUp(4));
  }

  int Get(const char* path) const { return wire::HttpGet(admin_, path).status; }
  bool Becomes(int readiness) const {
    return Eventually([&] { return Get("/readyz") == readiness; }, kPatience);
  }

  // The bytes that a set of "s" answers; a failure of the test when it does not.
  static std::string Answer(FaultClient& client, const std::string& set = "h",
                            const std::vector<std::string>& ids = kIds) {
    v1::DeformResponse response;
    const grpc::Status status = client.Deform("s", set, FixedTargets(ids), &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return BytesOf(response.shape());
  }

  // Every kind of call on "s", which is in memory and warm: only the store says whether another
  // server has changed it meanwhile. The last would take the session away.
  std::vector<grpc::Status> AskEverything() {
    std::vector<grpc::Status> answers;
    answers.push_back(client_->CreateSession("new"));
    answers.push_back(client_->Register("s", "n", wire::Grid(2, 2)));
    answers.push_back(client_->Compile("s", "m", "i", {wire::VertexHandle("c", 1)}));
    answers.push_back(client_->Deform("s", "h", FixedTargets(kIds)));
    {
      v1::EditHandlesRequest request;
      request.set_session_id("s");
      request.set_handle_set_id("h");
      request.add_remove("b");
      v1::EditHandlesResponse response;
      answers.push_back(client_->Call(&Stub::EditHandles, request, &response));
    }
    {
      v1::ListSessionsResponse response;
      answers.push_back(client_->Call(&Stub::ListSessions, v1::ListSessionsRequest(), &response));
    }
    {
      wire::DeformStream stream(client_->deformation());
      stream.Open("s", "h", v1::DELIVERY_LATEST);
      EXPECT_FALSE(stream.Read());
      answers.push_back(stream.Finish());
    }
    answers.push_back(client_->DeleteSession("s"));
    return answers;
  }

  // All of these, one after the other, in less than `limit`.
  void ExpectRefusals(seconds limit) {
    const auto start = steady_clock::now();
    const std::vector<grpc::Status> answers = AskEverything();
    EXPECT_LT(steady_clock::now() - start, limit);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      SCOPED_TRACE("call " + std::to_string(i));
      wire::ExpectError(answers[i], grpc::UNAVAILABLE, "STORE_UNAVAILABLE");  // with RetryInfo
    }
    EXPECT_TRUE(client_->Info().ok());
    EXPECT_EQ(Get("/healthz"), 200);
  }

  testing::RedisServer redis_;
  TempFolder blobs_;
  const std::vector<std::string> flags_{"--store", redis_.Url(), "--blob-dir", blobs_.path()};
  ServerProcess a_{flags_, "unix:{}/socket"};
  ServerProcess b_{flags_, "unix:{}/socket"};
  std::string admin_;  // of a_
  std::optional<FaultClient> client_;
};

TEST_F(RedisTest, GoneIsSaidAtOnceAndStreamsGoOn) {
  const std::string before = Answer(*client_);
  const MaybeSession session = ReadSession(*client_, "s");
  wire::DeformStream stream(client_->deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  redis_.Kill();
  ExpectRefusals(seconds(5));
  stream.Update(1, {wire::TargetAt("b", 5, 1)});
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
  EXPECT_TRUE(Becomes(503));

  redis_.Restart();
  ASSERT_TRUE(Becomes(200));
  EXPECT_EQ(Answer(*client_), before);
  EXPECT_EQ(Difference(session, ReadSession(*client_, "s")), "");
  EXPECT_TRUE(client_->CreateSession("new").ok());
  stream.Update(2, {wire::TargetAt("b", 6, 1)});
  EXPECT_EQ(stream.ReadShape().sequence(), 2u) << "the same process, the same stream";

  // Not only from the memory of this server.
  ASSERT_TRUE(b_.Start());
  FaultClient other(b_.address());
  EXPECT_EQ(Answer(other), before);
  EXPECT_EQ(ReadSessionIds(other), (std::vector<std::string>{"new", "s"}));
}

// The store's timeout is a second. It is paid now and then and not by every call: all of them
// together end before as many seconds.
TEST_F(RedisTest, AHangEndsWithTheTimeoutAndFramesGoOn) {
  const std::string before = Answer(*client_);
  Bystander bystander(a_.address());
  EXPECT_TRUE(bystander.GoesOn());
  redis_.Freeze();
  ExpectRefusals(seconds(6));
  EXPECT_TRUE(Becomes(503));
  EXPECT_TRUE(bystander.GoesOn());

  redis_.Thaw();
  ASSERT_TRUE(Becomes(200));
  // A call that gave up in this very moment makes others wait a second more.
  ASSERT_TRUE(Eventually([&] { return client_->Deform("s", "h", FixedTargets(kIds)).ok(); }));
  EXPECT_EQ(Answer(*client_), before);
  EXPECT_EQ(ReadSessionIds(*client_), (std::vector<std::string>{"bystander", "s"}));
  EXPECT_TRUE(client_->CreateSession("new").ok());
  EXPECT_TRUE(bystander.GoesOn());
  bystander.Stop();
}

TEST_F(RedisTest, WhatOneServerChangesTheOtherSees) {
  ASSERT_TRUE(b_.Start());
  FaultClient other(b_.address());
  const std::string before = Answer(*client_);
  EXPECT_EQ(Answer(other), before);

  // Both have the set in memory now.
  v1::EditHandlesRequest edit;
  edit.set_session_id("s");
  edit.set_handle_set_id("h");
  edit.add_remove("b");
  *edit.add_add() = wire::VertexHandle("c", 24);
  v1::EditHandlesResponse edited;
  ASSERT_TRUE(other.Call(&Stub::EditHandles, edit, &edited).ok());
  v1::DeformResponse seen;
  ASSERT_TRUE(client_->Deform("s", "h", FixedTargets({"a", "c"}), &seen).ok());
  EXPECT_EQ(seen.shape().handle_set_revision(), 2u);
  EXPECT_EQ(BytesOf(seen.shape()), Answer(other, "h", {"a", "c"}));
  EXPECT_NE(BytesOf(seen.shape()), before);

  ASSERT_TRUE(client_->Compile("s", "m", "i", {wire::VertexHandle("d", 2)}).ok());
  EXPECT_EQ(Answer(other, "i", {"d"}), Answer(*client_, "i", {"d"}));

  ASSERT_TRUE(client_->DeleteSession("s").ok());
  wire::ExpectError(other.Deform("s", "h", {}), grpc::NOT_FOUND, "NOT_FOUND");
}

}  // namespace
}  // namespace arap::fault
