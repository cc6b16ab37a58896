// The outbox of a stream: order, replacement, pongs.
#include <utility>

#include <gtest/gtest.h>

#include "server/streams/stream_policy.h"

namespace arap::app {
namespace {

using Kind = StreamAnswer::Kind;

StreamAnswer Shape(std::uint64_t sequence, std::uint64_t replaced = 0) {
  StreamAnswer answer;
  answer.kind = Kind::kShape;
  answer.sequence = sequence;
  answer.replaced = replaced;
  return answer;
}

StreamAnswer Error(std::uint64_t sequence) {
  StreamAnswer answer;
  answer.kind = Kind::kError;
  answer.sequence = sequence;
  answer.fault = Fault(FaultKind::kUnknownHandle, "There is no handle.");
  return answer;
}

StreamAnswer Next(StreamOutbox& outbox) {
  auto next = outbox.Pop();
  EXPECT_TRUE(next.has_value());
  return next ? *std::move(next) : StreamAnswer();
}

TEST(StreamOutboxTest, KeepsTheOrder) {
  StreamOutbox outbox;
  outbox.PushUpdate(Shape(1), false);
  outbox.PushUpdate(Shape(2), false);
  outbox.Push(Error(3));
  EXPECT_EQ(Next(outbox).sequence, 1u);
  EXPECT_EQ(Next(outbox).sequence, 2u);
  const StreamAnswer error = Next(outbox);
  EXPECT_EQ(error.kind, Kind::kError);
  EXPECT_EQ(error.sequence, 3u);
  EXPECT_FALSE(outbox.Pop().has_value());
}

TEST(StreamOutboxTest, NewShapeReplacesTheOneThatWaitsAndCountsIt) {
  StreamOutbox outbox;
  outbox.PushUpdate(Shape(4, 2), true);
  EXPECT_TRUE(outbox.replaceable());
  outbox.PushUpdate(Shape(9, 3), true);
  const StreamAnswer answer = Next(outbox);
  EXPECT_EQ(answer.sequence, 9u);
  EXPECT_EQ(answer.replaced, 6u);
  EXPECT_TRUE(outbox.empty());
}

TEST(StreamOutboxTest, AnswersToEditsAreNotReplaced) {
  StreamOutbox outbox;
  outbox.Push(Shape(1));
  EXPECT_FALSE(outbox.replaceable());
  outbox.PushUpdate(Shape(2), true);
  EXPECT_EQ(Next(outbox).sequence, 1u);
  EXPECT_EQ(Next(outbox).sequence, 2u);
}

TEST(StreamOutboxTest, PongGoesFirst) {
  StreamOutbox outbox;
  outbox.PushUpdate(Shape(1), true);
  outbox.SetPong(7);
  EXPECT_TRUE(outbox.pong_waits());
  const StreamAnswer pong = Next(outbox);
  EXPECT_EQ(pong.kind, Kind::kPong);
  EXPECT_EQ(pong.nonce, 7u);
  EXPECT_FALSE(outbox.pong_waits());
  EXPECT_EQ(Next(outbox).sequence, 1u);
}

}  // namespace
}  // namespace arap::app
