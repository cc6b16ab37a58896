// StreamDeform over the wire: the protocol and both deliveries.

#include "tests/support/bounded.h"
#include "tests/system/wire/stream_fixture.h"

namespace arap::wire {
namespace {

TEST_F(StreamTest, OpensAnswersAndEndsWithHalfClose) {
  DeformStream stream(deformation());
  const v1::HandleSetInfo set = stream.Opened("s", "h", v1::DELIVERY_LATEST);
  EXPECT_EQ(set.handles_size(), 3);
  EXPECT_EQ(set.revision(), 1u);
  stream.Update(7, Moved(2));
  const v1::Shape shape = stream.ReadShape();
  EXPECT_EQ(shape.sequence(), 7u);
  EXPECT_EQ(shape.replaced(), 0u);
  EXPECT_EQ(shape.handle_set_revision(), 1u);
  EXPECT_NEAR(shape.positions(0), 2, 1e-4);
  EXPECT_GT(shape.solve_micros(), 0);
  EXPECT_GT(shape.queue_micros(), 0);
  stream.HalfClose();
  EXPECT_FALSE(stream.Read().has_value());
  EXPECT_TRUE(stream.Finish().ok());
}

TEST_F(StreamTest, EqualsSingleDeformation) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  stream.Update(1, Moved(3));
  stream.ReadShape();
  auto targets = Moved(0);
  targets[1].set_y(1);
  stream.Update(2, targets);
  const v1::Shape streamed = stream.ReadShape();
  v1::DeformResponse single;
  ASSERT_TRUE(Deform("s", "h", targets, &single).ok());
  EXPECT_TRUE(std::equal(streamed.positions().begin(), streamed.positions().end(),
                         single.shape().positions().begin()));
}

TEST_F(StreamTest, FirstMessageMustOpen) {
  v1::StreamDeformRequest request;
  request.mutable_update()->set_sequence(1);
  ExpectError(Only(request), grpc::FAILED_PRECONDITION, "PROTOCOL");
  request.mutable_ping()->set_nonce(1);
  ExpectError(Only(request), grpc::FAILED_PRECONDITION, "PROTOCOL");
  ExpectError(Only(v1::StreamDeformRequest()), grpc::FAILED_PRECONDITION, "PROTOCOL");
  DeformStream silent(deformation());
  silent.HalfClose();
  EXPECT_FALSE(silent.Read().has_value());
  ExpectError(silent.Finish(), grpc::FAILED_PRECONDITION, "PROTOCOL");
}

TEST_F(StreamTest, SecondOpenAndEmptyMessageEndTheStream) {
  DeformStream twice(deformation());
  twice.Opened("s", "h", v1::DELIVERY_LATEST);
  twice.Open("s", "h", v1::DELIVERY_LATEST);
  EXPECT_FALSE(twice.Read().has_value());
  ExpectError(twice.Finish(), grpc::FAILED_PRECONDITION, "PROTOCOL");
  DeformStream empty(deformation());
  empty.Opened("s", "h", v1::DELIVERY_LATEST);
  empty.Send({});
  EXPECT_FALSE(empty.Read().has_value());
  ExpectError(empty.Finish(), grpc::FAILED_PRECONDITION, "PROTOCOL");
}

TEST_F(StreamTest, OpeningWhatIsNotThereEndsTheStream) {
  v1::StreamDeformRequest request;
  request.mutable_open()->set_session_id("t");
  ExpectError(Only(request), grpc::NOT_FOUND, "NOT_FOUND");
  request.mutable_open()->set_session_id("s");
  request.mutable_open()->set_handle_set_id("none");
  ExpectError(Only(request), grpc::NOT_FOUND, "NOT_FOUND");
  request.mutable_open()->set_handle_set_id("h");
  request.mutable_open()->mutable_options()->set_refine(1'000'000);
  ExpectError(Only(request), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
}

TEST_F(StreamTest, LatestAnswersTheNewestAndCountsTheReplaced) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  {
    PoolGate gate(host().engine().interactive);
    for (std::uint64_t i = 1; i <= 10; ++i) stream.Update(i, Moved(static_cast<double>(i)));
    stream.Ping(1);
  }
  const v1::Shape last = ReadUntil(stream, 10);
  EXPECT_GE(last.replaced(), 8u) << "the last took the place of the eight before it";
  EXPECT_NEAR(last.positions(0), 10, 1e-4);
}

TEST_F(StreamTest, LatestKeepsTheTargetsOfReplacedUpdates) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  {
    PoolGate gate(host().engine().interactive);
    stream.Update(1, {});
    stream.Update(2, {TargetAt("a", 5, 0)});
    stream.Update(3, {TargetAt("b", 9, 0)});
    stream.Update(4, {TargetAt("c", 5, 4)});
    stream.Ping(1);
  }
  const v1::Shape shape = ReadUntil(stream, 4);
  EXPECT_NEAR(shape.positions(0), 5, 1e-4);
  EXPECT_NEAR(shape.positions(8), 9, 1e-4);
  EXPECT_NEAR(shape.positions(40), 5, 1e-4);
}

TEST_F(StreamTest, EveryAnswersEachInOrder) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  constexpr std::uint64_t kUpdates = 200;
  testing::BoundedThread sender("the sender", [&] {
    for (std::uint64_t i = 1; i <= kUpdates; ++i) stream.Update(i, Moved(static_cast<double>(i)));
    stream.HalfClose();
  });
  for (std::uint64_t i = 1; i <= kUpdates; ++i) {
    const v1::Shape shape = stream.ReadShape();
    ASSERT_EQ(shape.sequence(), i);
    EXPECT_EQ(shape.replaced(), 0u);
    EXPECT_NEAR(shape.positions(0), static_cast<double>(i), 1e-2);
  }
  EXPECT_FALSE(stream.Read().has_value());
  EXPECT_TRUE(stream.Finish().ok());
  sender.Join();
}

TEST_F(StreamTest, HalfCloseAnswersWhatIsPending) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  {
    PoolGate gate(host().engine().interactive);
    stream.Update(1, Moved(1));
    stream.Update(2, Moved(2));
    stream.HalfClose();
    // Nothing says when a half-close has arrived; either way both updates came before it.
  }
  ReadUntil(stream, 2);
  EXPECT_FALSE(stream.Read().has_value());
  EXPECT_TRUE(stream.Finish().ok());
}

TEST_F(StreamTest, PongComesWhileWorkWaits) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  PoolGate gate(host().engine().interactive);
  stream.Update(1, Moved(1));
  stream.Ping(41);
  stream.Ping(42);
  gate.Open();
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
}

}  // namespace
}  // namespace arap::wire
