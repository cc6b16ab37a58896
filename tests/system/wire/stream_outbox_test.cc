// The outbox of a stream: order, replacement, pongs.
#include "server/rpc/stream_outbox.h"

#include <utility>

#include <gtest/gtest.h>

namespace arap::rpc {
namespace {

using Message = StreamOutbox::Message;

Message Shape(std::uint64_t sequence, std::uint64_t replaced = 0) {
  Message message;
  message.mutable_shape()->set_sequence(sequence);
  message.mutable_shape()->set_replaced(replaced);
  return message;
}

Message Next(StreamOutbox& outbox) {
  Message message;
  EXPECT_TRUE(outbox.Pop(&message));
  return message;
}

TEST(StreamOutboxTest, KeepsTheOrder) {
  StreamOutbox outbox;
  outbox.PushUpdate(Shape(1), false);
  outbox.PushUpdate(Shape(2), false);
  outbox.PushError(3, {FaultKind::kUnknownHandle, "There is no handle."});
  EXPECT_EQ(Next(outbox).shape().sequence(), 1u);
  EXPECT_EQ(Next(outbox).shape().sequence(), 2u);
  EXPECT_EQ(Next(outbox).error().sequence(), 3u);
  Message none;
  EXPECT_FALSE(outbox.Pop(&none));
}

TEST(StreamOutboxTest, NewShapeReplacesTheOneThatWaitsAndCountsIt) {
  StreamOutbox outbox;
  outbox.PushUpdate(Shape(4, 2), true);
  EXPECT_TRUE(outbox.replaceable());
  outbox.PushUpdate(Shape(9, 3), true);
  const Message message = Next(outbox);
  EXPECT_EQ(message.shape().sequence(), 9u);
  EXPECT_EQ(message.shape().replaced(), 6u);
  EXPECT_TRUE(outbox.empty());
}

TEST(StreamOutboxTest, AnswersToEditsAreNotReplaced) {
  StreamOutbox outbox;
  outbox.Push(Shape(1));
  EXPECT_FALSE(outbox.replaceable());
  outbox.PushUpdate(Shape(2), true);
  EXPECT_EQ(Next(outbox).shape().sequence(), 1u);
  EXPECT_EQ(Next(outbox).shape().sequence(), 2u);
}

TEST(StreamOutboxTest, PongGoesFirst) {
  StreamOutbox outbox;
  outbox.PushUpdate(Shape(1), true);
  outbox.SetPong(7);
  EXPECT_TRUE(outbox.pong_waits());
  EXPECT_EQ(Next(outbox).pong().nonce(), 7u);
  EXPECT_FALSE(outbox.pong_waits());
  EXPECT_EQ(Next(outbox).shape().sequence(), 1u);
}

}  // namespace
}  // namespace arap::rpc
