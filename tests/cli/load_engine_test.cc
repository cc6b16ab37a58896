// The load generator on the wire, against servers that do as a test says. Nothing here depends on how
// fast the machine is: where a server is slow, it waits for a message that is due later.
#include <algorithm>
#include <deque>
#include <map>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "client/cli/load/load_run.h"
#include "tests/cli/load_stub.h"
#include "tests/support/folder.h"

namespace arap::cli {
namespace {

using testing::AllOf;
using testing::Each;
using testing::Field;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;
using testing::UnorderedElementsAre;

LoadRequest To(const LoadStub& stub) {
  LoadRequest request;
  request.server.server = stub.address();
  request.vertices = 16;
  request.handles = 2;
  request.streams = 1;
  request.quiet = true;
  return request;
}

LoadResults Measure(const LoadRequest& request) {
  auto results = RunLoad(request, {});
  EXPECT_TRUE(results) << results.error().message;
  return results ? *std::move(results) : LoadResults{};
}

grpc::Status ServeAll(LoadStub& stub, LoadStub::Stream& stream, std::size_t /*number*/) {
  return stub.Serve(stream);
}

TEST(LoadEngine, AClosedLoopKeepsItsWindow) {
  for (const std::size_t window : {1u, 3u}) {
    std::atomic<std::size_t> most = 0;
    // Answers nothing before the window must be full, or the sending is over.
    const auto script = [&](LoadStub& own, LoadStub::Stream& stream, std::size_t) {
      std::deque<LoadStub::Request> waiting;
      std::size_t read = 0;
      LoadStub::Request request;
      while (read < 30 && stream.Read(&request)) {
        ++read;
        waiting.push_back(request);
        most = std::max<std::size_t>(most, waiting.size());
        if (waiting.size() < window && read < 30) continue;
        own.Answer(stream, waiting.front());
        waiting.pop_front();
      }
      for (const LoadStub::Request& rest : waiting) own.Answer(stream, rest);
      while (stream.Read(&request)) own.Answer(stream, request);
      return grpc::Status::OK;
    };
    LoadStub stub(script);
    LoadRequest request = To(stub);
    request.window = window;
    request.count = 30;
    const LoadResults results = Measure(request);
    const OperationResults& drags = results.operations[Operation::kDrag];
    EXPECT_THAT(results.errors, IsEmpty());
    EXPECT_EQ(drags.sent, 30u);
    EXPECT_EQ(drags.answered, 30u);
    EXPECT_EQ(most, window);
    EXPECT_GT(results.own_nanos_per_message, 0);
    EXPECT_EQ(stub.sessions(), 0u) << "they are deleted";
  }
}

// The 20th message is answered when the 40th is there, which is due a fifth of a second later.
TEST(LoadEngine, AnOpenLoopDoesNotWaitForAServerThatStalls) {
  LoadStub stub([](LoadStub& own, LoadStub::Stream& stream, std::size_t) {
    std::deque<LoadStub::Request> waiting;
    std::size_t read = 0;
    for (LoadStub::Request request; stream.Read(&request);) {
      ++read;
      waiting.push_back(request);
      if (read >= 20 && read < 40) continue;
      for (const LoadStub::Request& one : waiting) own.Answer(stream, one);
      waiting.clear();
    }
    return grpc::Status::OK;
  });
  LoadRequest request = To(stub);
  request.rate = 100;
  request.seconds = 0.6;
  const LoadResults results = Measure(request);
  const OperationResults& drags = results.operations[Operation::kDrag];
  EXPECT_EQ(drags.sent + drags.unsent, 60u) << "what is due does not depend on the server";
  if (drags.sent < 40) GTEST_SKIP() << "the machine sent only " << drags.sent;
  EXPECT_THAT(results.errors, IsEmpty());
  EXPECT_EQ(drags.answered, drags.sent);
  // Message 20 + k waits for 20 - k hundredths of a second at least: ten of sixty for a tenth.
  EXPECT_GE(drags.response.Max(), 0.99 * 200'000);
  EXPECT_LE(drags.response.PartWithin(0.97 * 100'000), 50.0 / static_cast<double>(drags.sent));
  EXPECT_LE(drags.service.Max(), drags.response.Max() * 1.01);
}

TEST(LoadEngine, StreamsShareSessionsAndConnections) {
  LoadStub stub(&ServeAll);
  LoadRequest request = To(stub);
  request.streams = 20;
  request.sessions = 3;
  request.connections = 2;
  request.count = 100;
  const LoadResults results = Measure(request);
  EXPECT_THAT(results.errors, IsEmpty());
  EXPECT_EQ(results.sessions, 3u);
  EXPECT_EQ(results.connections, 2u);
  EXPECT_EQ(stub.streams(), 20u);
  EXPECT_EQ(results.operations[Operation::kDrag].answered, 100u);
}

class LoadTokens : public FolderTest {};

// Seven sessions on three tokens, of which the server knows one: what becomes of each token's share is in
// the errors by code.
TEST_F(LoadTokens, EachHasItsShareOfTheSessions) {
  std::mutex mutex;
  std::map<std::string, std::size_t> asked;
  LoadStub stub(&ServeAll, [&](const std::string& authorization) {
    const std::lock_guard lock(mutex);
    ++asked[authorization];
    if (authorization == "Bearer two")
      return grpc::Status(grpc::StatusCode::UNAUTHENTICATED, "who?");
    if (authorization == "Bearer three")
      return grpc::Status(grpc::StatusCode::PERMISSION_DENIED, "no");
    return grpc::Status::OK;
  });
  LoadRequest request = To(stub);
  request.server.token_file = Put("one", "one\n");
  request.more_token_files = {Put("two", "two\n"), Put("three", "three\n")};
  request.streams = 7;
  request.count = 70;
  const LoadResults results = Measure(request);
  EXPECT_THAT(asked, UnorderedElementsAre(Pair("Bearer one", 3u), Pair("Bearer two", 2u),
                                          Pair("Bearer three", 2u)));
  EXPECT_THAT(
      results.errors,
      UnorderedElementsAre(
          AllOf(Field(&LoadError::code, "UNAUTHENTICATED"), Field(&LoadError::count, 2u)),
          AllOf(Field(&LoadError::code, "PERMISSION_DENIED"), Field(&LoadError::count, 2u))));
  EXPECT_EQ(results.connections, 3u) << "one for each token";
  EXPECT_EQ(stub.streams(), 3u);
  EXPECT_EQ(results.operations[Operation::kDrag].answered, 30u)
      << "what the streams of one have of it";
}

TEST(LoadEngine, PingsGoBesideTheMessages) {
  LoadStub stub(&ServeAll);
  LoadRequest request = To(stub);
  request.rate = 50;
  request.echo = 50;
  request.seconds = 2;
  const LoadResults results = Measure(request);
  EXPECT_THAT(results.errors, IsEmpty());
  EXPECT_GT(results.echo.Count(), 0u);
  EXPECT_LE(results.echo.Count(), 100u);
}

// An hour of a server that never answers.
TEST(LoadEngine, EndsWhenItIsToldTo) {
  std::stop_source stop;
  LoadStub stub([&](LoadStub&, LoadStub::Stream& stream, std::size_t) {
    LoadStub::Request request;
    stream.Read(&request);
    stop.request_stop();
    while (stream.Read(&request)) {
    }
    return grpc::Status::CANCELLED;
  });
  LoadRequest request = To(stub);
  request.seconds = 3600;
  const auto results = RunLoad(request, stop.get_token());
  ASSERT_TRUE(results) << results.error().message;
  EXPECT_EQ(results->operations[Operation::kDrag].sent, 1u);
  EXPECT_EQ(results->operations[Operation::kDrag].answered, 0u);
}

TEST(LoadEngine, AStreamThatIsLostGoesOn) {
  // The first one ends after ten answers, with the eleventh message unanswered.
  LoadStub stub([](LoadStub& own, LoadStub::Stream& stream, std::size_t number) {
    if (number > 0) return own.Serve(stream);
    LoadStub::Request request;
    for (int i = 0; i < 10 && stream.Read(&request); ++i) own.Answer(stream, request);
    stream.Read(&request);
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "going away");
  });
  LoadRequest request = To(stub);
  request.count = 40;
  const LoadResults results = Measure(request);
  const OperationResults& drags = results.operations[Operation::kDrag];
  EXPECT_THAT(results.errors, IsEmpty());
  EXPECT_EQ(results.resumptions, 1u);
  EXPECT_EQ(results.frames_lost, 0u);
  EXPECT_EQ(drags.sent, 40u);
  EXPECT_EQ(drags.answered, 40u);
}

TEST(LoadEngine, AStreamThatMayNotResumeEndsAndTheRunGoesOn) {
  LoadStub stub([](LoadStub& own, LoadStub::Stream& stream, std::size_t number) {
    if (number > 0) return own.Serve(stream);
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "going away");
  });
  LoadRequest request = To(stub);
  request.streams = 2;
  request.count = 40;
  request.resume = 0;
  const LoadResults results = Measure(request);
  const OperationResults& drags = results.operations[Operation::kDrag];
  ASSERT_THAT(results.errors, SizeIs(1));
  EXPECT_EQ(results.errors[0].code, "UNAVAILABLE");
  EXPECT_EQ(results.errors[0].count, 1u);
  EXPECT_EQ(drags.answered, 20u) << "those of the other stream";
}

TEST(LoadEngine, WrongAnswersAreCountedByWhatIsWrong) {
  const struct {
    const char* name;
    void (*spoil)(LoadStub::Response& response);
    const char* reason;
  } cases[] = {
      {"another sequence", [](auto& r) { r.mutable_shape()->set_sequence(77); }, "BAD_REPLY"},
      {"too short", [](auto& r) { r.mutable_shape()->mutable_positions()->Resize(2, 0); },
       "BAD_REPLY"},
      {"nothing", [](auto& r) { r.Clear(); }, "BAD_REPLY"},
      {"a pong", [](auto& r) { r.mutable_pong()->set_nonce(5); }, "BAD_REPLY"},
      {"an error",
       [](auto& r) {
         const std::uint64_t sequence = r.shape().sequence();
         r.mutable_error()->set_sequence(sequence);
         r.mutable_error()->mutable_status()->set_code(8);
       },
       "OVERLOADED"},
  };
  for (const auto& one : cases) {
    LoadStub stub([&](LoadStub&, LoadStub::Stream& stream, std::size_t) {
      for (LoadStub::Request request; stream.Read(&request);) {
        LoadStub::Response response;
        response.mutable_shape()->set_sequence(request.update().sequence());
        response.mutable_shape()->mutable_positions()->Resize(32, 0);
        one.spoil(response);
        stream.Write(response);
      }
      return grpc::Status::OK;
    });
    LoadRequest request = To(stub);
    request.count = 3;
    const LoadResults results = Measure(request);
    const OperationResults& drags = results.operations[Operation::kDrag];
    ASSERT_THAT(results.errors, SizeIs(1)) << one.name;
    EXPECT_EQ(results.errors[0].reason, one.reason) << one.name;
    EXPECT_NE(results.errors[0].first, "") << one.name;
    EXPECT_EQ(drags.answered, 0u) << one.name;
    EXPECT_GT(drags.failed, 0u) << one.name;
    EXPECT_LE(drags.failed, 3u) << one.name;
  }
}

// The private server that computes them again is the real one.
TEST(LoadEngine, ShapesThatAreOthersAreFound) {
  LoadStub stub(&ServeAll);
  LoadRequest request = To(stub);
  request.count = 20;
  request.verify = 1;
  const auto mix = Mix::Parse("drag=3,edit=1");
  ASSERT_TRUE(mix) << mix.error().message;
  request.mix = *mix;
  const LoadResults results = Measure(request);
  const OperationResults& drags = results.operations[Operation::kDrag];
  const OperationResults& edits = results.operations[Operation::kEdit];
  EXPECT_EQ(drags.answered + edits.answered, 20u);
  EXPECT_GT(drags.verified, 0u);
  EXPECT_GT(edits.verified, 0u);
  EXPECT_EQ(drags.wrong, drags.verified) << "they are all zeros";
  EXPECT_EQ(edits.wrong, edits.verified);
}

TEST(LoadEngine, ASearchStopsWhereNothingIsMet) {
  LoadStub stub(&ServeAll);
  LoadRequest request = To(stub);
  request.seconds = 0.1;
  request.warm_up = 0.1;
  request.rate = 20;
  request.resolution = 1;
  const auto rule = ParseThreshold("p99<0.001us");
  ASSERT_TRUE(rule) << rule.error().message;
  request.search = *rule;
  const LoadResults results = Measure(request);
  EXPECT_FALSE(results.rate_found);
  ASSERT_FALSE(results.steps.empty());
  EXPECT_THAT(results.steps, Each(Field(&LoadStep::met, false)));
  EXPECT_EQ(results.steps.front().rate, 20);
  EXPECT_EQ(results.steps.back().rate, 0.1);
  EXPECT_EQ(results.warm_up_seconds, 0.1) << "of each";
  for (const LoadStep& step : results.steps) {
    EXPECT_LE(step.answered * step.seconds, step.rate * step.seconds + 1)
        << "what warms up counts not";
  }
}

TEST(LoadEngine, AProfileHasAStepForEachOfItsRates) {
  LoadStub stub(&ServeAll);
  LoadRequest request = To(stub);
  request.seconds = 0.4;
  request.warm_up = 0.1;
  request.profile = "step:50,100";
  const LoadResults results = Measure(request);
  ASSERT_THAT(results.steps, SizeIs(2));
  EXPECT_EQ(results.steps[0].rate, 50);
  EXPECT_EQ(results.steps[1].rate, 100);
  const OperationResults& drags = results.operations[Operation::kDrag];
  EXPECT_EQ(drags.sent + drags.unsent, 30u) << "what warms up does not count";
  EXPECT_DOUBLE_EQ(results.warm_up_seconds, 0.2) << "one for each";
}

}  // namespace
}  // namespace arap::cli
