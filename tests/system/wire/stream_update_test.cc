// Updates of a stream: what they may say, and what is said of bad ones.
#include <limits>

#include "tests/system/wire/stream_fixture.h"

namespace arap::wire {
namespace {

TEST_F(StreamTest, UpdateMayMoveSomeHandles) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  stream.Update(1, Moved(3));
  stream.ReadShape();
  stream.Update(2, {TargetAt("b", 7, 1)});
  const v1::Shape shape = stream.ReadShape();
  EXPECT_NEAR(shape.positions(0), 3, 1e-3) << "a keeps its target";
  EXPECT_NEAR(shape.positions(8), 7, 1e-3);
  EXPECT_NEAR(shape.positions(9), 1, 1e-3);
}

TEST_F(StreamTest, PackedPositionsMoveAllHandles) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  v1::StreamDeformRequest request;
  request.mutable_update()->set_sequence(1);
  for (const double value : {1.0, 0.0, 5.0, 0.0, 1.0, 4.0}) {
    request.mutable_update()->add_positions(value);
  }
  stream.Send(request);
  EXPECT_NEAR(stream.ReadShape().positions(0), 1, 1e-4);

  request.mutable_update()->mutable_positions()->RemoveLast();
  stream.Send(request);
  const auto count =
      ExpectError(stream.ReadError().status(), grpc::INVALID_ARGUMENT, "TARGET_COUNT");
  EXPECT_EQ(count.metadata.at("expected"), "3");
  request.mutable_update()->add_positions(std::numeric_limits<double>::quiet_NaN());
  stream.Send(request);
  ExpectError(stream.ReadError().status(), grpc::INVALID_ARGUMENT, "NON_FINITE_TARGET");
  request.mutable_update()->set_positions(5, 4);
  *request.mutable_update()->add_targets() = TargetAt("a", 0, 0);
  stream.Send(request);
  ExpectError(stream.ReadError().status(), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
}

TEST_F(StreamTest, BadUpdateIsAnsweredInTheStreamAndChangesNothing) {
  for (const v1::Delivery delivery : {v1::DELIVERY_EVERY, v1::DELIVERY_LATEST}) {
    DeformStream stream(deformation());
    stream.Opened("s", "h", delivery);
    stream.Update(1, Moved(1));
    stream.ReadShape();
    stream.Update(2, {TargetAt("a", 9, 9), TargetAt("nobody", 0, 0)});
    v1::UpdateError error = stream.ReadError();
    EXPECT_EQ(error.sequence(), 2u);
    ExpectError(error.status(), grpc::NOT_FOUND, "UNKNOWN_HANDLE");
    stream.Update(3, {TargetAt("a", std::numeric_limits<double>::quiet_NaN(), 0)});
    error = stream.ReadError();
    EXPECT_EQ(error.sequence(), 3u);
    ExpectError(error.status(), grpc::INVALID_ARGUMENT, "NON_FINITE_TARGET");
    stream.Update(4, {});
    EXPECT_NEAR(stream.ReadShape().positions(0), 1, 1e-4);
    stream.HalfClose();
    EXPECT_FALSE(stream.Read().has_value());
    EXPECT_TRUE(stream.Finish().ok());
  }
}

// A pair of hard handles on one vertex: each update is judged by itself, before it is computed.
TEST_F(StreamTest, ContradictingHardHandlesAreRefusedAndChangeNothing) {
  v1::Handle p = VertexHandle("p", 6);
  v1::Handle q = VertexHandle("q", 6);
  p.set_hard(true);
  q.set_hard(true);
  ASSERT_TRUE(Compile("s", "m", "hard", {p, q}).ok());
  for (const v1::Delivery delivery : {v1::DELIVERY_EVERY, v1::DELIVERY_LATEST}) {
    DeformStream stream(deformation());
    stream.Opened("s", "hard", delivery);
    {
      PoolGate gate(host().engine().interactive);
      stream.Update(1, {TargetAt("p", 3, 1), TargetAt("q", 3, 1)});
      stream.Update(2, {TargetAt("p", 5, 1)});
      stream.Update(3, {});
    }
    EXPECT_EQ(stream.ReadShape().sequence(), 1u);
    const v1::UpdateError error = stream.ReadError();
    EXPECT_EQ(error.sequence(), 2u);
    ExpectError(error.status(), grpc::INVALID_ARGUMENT, "CONFLICTING_HANDLES");
    const v1::Shape shape = stream.ReadShape();
    EXPECT_EQ(shape.sequence(), 3u);
    EXPECT_NEAR(shape.positions(12), 3, 1e-5) << "where update 1 put it";
    v1::StreamDeformRequest packed;
    packed.mutable_update()->set_sequence(4);
    for (const double x : {5.0, 1.0, 6.0, 1.0}) packed.mutable_update()->add_positions(x);
    stream.Send(packed);
    ExpectError(stream.ReadError().status(), grpc::INVALID_ARGUMENT, "CONFLICTING_HANDLES");
    packed.mutable_update()->set_positions(2, 5);
    stream.Send(packed);
    EXPECT_NEAR(stream.ReadShape().positions(12), 5, 1e-5);
  }
}

TEST_F(StreamTest, ErrorsKeepTheirPlaceAmongTheAnswers) {
  for (const v1::Delivery delivery : {v1::DELIVERY_EVERY, v1::DELIVERY_LATEST}) {
    DeformStream stream(deformation());
    stream.Opened("s", "h", delivery);
    {
      PoolGate gate(host().engine().interactive);
      stream.Update(1, Moved(1));
      stream.Update(2, {TargetAt("nobody", 0, 0)});
      stream.Update(3, Moved(3));
      stream.HalfClose();
    }
    EXPECT_EQ(stream.ReadShape().sequence(), 1u);
    EXPECT_EQ(stream.ReadError().sequence(), 2u);
    EXPECT_EQ(stream.ReadShape().sequence(), 3u);
    EXPECT_FALSE(stream.Read().has_value());
    EXPECT_TRUE(stream.Finish().ok());
  }
}

TEST_F(StreamTest, PicksComeWithTheirShapeAndBadOnesInTheStream) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  v1::StreamDeformRequest request;
  request.mutable_update()->set_sequence(7);
  request.mutable_update()->add_pick_points(1.5);
  stream.Send(request);
  ExpectError(stream.ReadError().status(), grpc::INVALID_ARGUMENT, "ARRAY_LENGTH");
  request.mutable_update()->add_pick_points(1.5);
  stream.Send(request);
  const v1::Shape shape = stream.ReadShape();  // at rest: the point is its own rest
  ASSERT_EQ(shape.picks_size(), 1);
  EXPECT_TRUE(shape.picks(0).hit());
  EXPECT_NEAR(shape.picks(0).rest().x(), 1.5, 1e-9);
  EXPECT_NEAR(shape.picks(0).rest().y(), 1.5, 1e-9);
}

}  // namespace
}  // namespace arap::wire
