// StreamDeform over the wire: the protocol, both deliveries, errors, edits, endings.
#include <future>
#include <limits>
#include <thread>

#include "tests/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class StreamTest : public WireTest {
 protected:
  void SetUp() override {
    options().lanes = {1, 1, 16};
    SetUpCorners();
  }

  static std::vector<v1::HandleTarget> Moved(double dx) {
    return {TargetAt("a", dx, 0), TargetAt("b", 4 + dx, 0), TargetAt("c", dx, 4)};
  }

  // The status of a stream that is sent just this message.
  grpc::Status Only(const v1::StreamDeformRequest& request) {
    DeformStream stream(deformation());
    stream.Send(request);
    EXPECT_FALSE(stream.Read().has_value());
    return stream.Finish();
  }

  // The shape that answers update `last`, of updates 1, 2, 3…: each must be answered or counted as
  // replaced, in order. How many are answered depends on when the server's writes end.
  static v1::Shape ReadUntil(DeformStream& stream, std::uint64_t last) {
    v1::Shape shape;
    std::uint64_t accounted = 0;
    do {
      const auto answer = stream.Read();
      if (!answer || !answer->has_shape()) {
        ADD_FAILURE() << "no shape after " << accounted;
        return shape;
      }
      shape = answer->shape();
      accounted += shape.replaced() + 1;
      EXPECT_EQ(shape.sequence(), accounted);
    } while (shape.sequence() < last);
    EXPECT_EQ(shape.sequence(), last);
    return shape;
  }

  static v1::StreamDeformRequest Edit(std::uint64_t sequence,
                                      const std::vector<std::string>& remove,
                                      const std::vector<v1::Handle>& add) {
    v1::StreamDeformRequest request;
    request.mutable_edit()->set_sequence(sequence);
    request.mutable_edit()->mutable_remove()->Assign(remove.begin(), remove.end());
    request.mutable_edit()->mutable_add()->Assign(add.begin(), add.end());
    return request;
  }
};

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
  std::thread sender([&] {
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
  sender.join();
}

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

TEST_F(StreamTest, EditChangesTheSetOfTheStreamOnly) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  stream.Update(1, Moved(3));
  const v1::Shape before = stream.ReadShape();
  stream.Send(Edit(2, {"b"}, {VertexHandle("d", 12)}));
  const v1::Shape after = stream.ReadShape();
  EXPECT_EQ(after.sequence(), 2u);
  EXPECT_EQ(after.handle_set_revision(), 2u);
  // The new handle starts where the shape has it, the others keep their targets: nothing moves.
  for (int i = 0; i < before.positions_size(); ++i) {
    EXPECT_NEAR(after.positions(i), before.positions(i), 1e-3);
  }
  stream.Update(3, {TargetAt("d", 6, 3)});
  const v1::Shape moved = stream.ReadShape();
  EXPECT_EQ(moved.handle_set_revision(), 2u);
  EXPECT_NEAR(moved.positions(24), 6, 1e-2);
  EXPECT_NEAR(moved.positions(25), 3, 1e-2);
  stream.Update(4, {TargetAt("b", 0, 0)});
  ExpectError(stream.ReadError().status(), grpc::NOT_FOUND, "UNKNOWN_HANDLE");
  EXPECT_TRUE(Deform("s", "h", Moved(0)).ok()) << "the stored set still has a, b and c";
}

TEST_F(StreamTest, EditBeforeAnyUpdateStartsFromRest) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  v1::Handle point;
  point.set_handle_id("p");
  point.mutable_position()->set_x(2.3);
  point.mutable_position()->set_y(1.1);
  point.set_oriented(true);
  stream.Send(Edit(1, {}, {point}));
  const v1::Shape shape = stream.ReadShape();
  const v1::PlanarMesh rest = Grid(4, 4);
  for (int i = 0; i < shape.positions_size(); ++i) {
    EXPECT_NEAR(shape.positions(i), rest.vertices(i), 1e-4);
  }
}

TEST_F(StreamTest, OrientedHandleAddedToATurnedShapeKeepsItTurned) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  // A quarter turn about the origin.
  stream.Update(1, {TargetAt("a", 0, 0), TargetAt("b", 0, 4), TargetAt("c", -4, 0)});
  const v1::Shape before = stream.ReadShape();
  v1::Handle turned = VertexHandle("d", 12);
  turned.set_oriented(true);
  stream.Send(Edit(2, {}, {turned}));
  const v1::Shape after = stream.ReadShape();
  for (int i = 0; i < before.positions_size(); ++i) {
    EXPECT_NEAR(after.positions(i), before.positions(i), 1e-3);
  }
}

TEST_F(StreamTest, BadEditIsAnsweredInTheStreamAndChangesNothing) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  stream.Send(Edit(1, {"nobody"}, {}));
  v1::UpdateError error = stream.ReadError();
  EXPECT_EQ(error.sequence(), 1u);
  ExpectError(error.status(), grpc::NOT_FOUND, "UNKNOWN_HANDLE");
  stream.Send(Edit(2, {"a"}, {VertexHandle("d", 1'000)}));
  const auto index =
      ExpectError(stream.ReadError().status(), grpc::INVALID_ARGUMENT, "INDEX_OUT_OF_RANGE");
  EXPECT_EQ(index.fields, std::vector<std::string>{"add[0]"});
  v1::Handle wide = VertexHandle("w", 3);
  wide.set_area_radius(-1);
  stream.Send(Edit(3, {}, {wide}));
  ExpectError(stream.ReadError().status(), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  stream.Update(4, Moved(1));
  EXPECT_EQ(stream.ReadShape().handle_set_revision(), 1u);
}

TEST_F(StreamTest, EditsWithAreasRunAsJobs) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  v1::Handle wide = VertexHandle("w", 12);
  wide.set_area_radius(1.1);
  {
    PoolGate interactive(host().engine().interactive);
    PoolGate jobs(host().engine().jobs);
    stream.Send(Edit(1, {}, {wide}));
    stream.Update(2, {TargetAt("w", 2, 2.5)});
  }
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
  const v1::Shape shape = stream.ReadShape();
  EXPECT_EQ(shape.sequence(), 2u);
  EXPECT_EQ(shape.handle_set_revision(), 2u);
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

TEST_F(StreamTest, DeletedSessionEndsItsStreams) {
  DeformStream idle(deformation());
  idle.Opened("s", "h", v1::DELIVERY_LATEST);
  v1::DeleteSessionRequest request;
  request.set_session_id("s");
  v1::DeleteSessionResponse response;
  ASSERT_TRUE(Call(&Deformation::DeleteSession, request, &response).ok());
  EXPECT_FALSE(idle.Read().has_value());
  ExpectError(idle.Finish(), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(StreamTest, DeletedSessionLetsTheFrameInWorkOut) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  PoolGate gate(host().engine().interactive);
  stream.Update(1, Moved(1));
  stream.Update(2, Moved(2));
  stream.Ping(1);
  ASSERT_TRUE(host().engine().sessions.Delete(app::kNobody, "s"));
  gate.Open();
  EXPECT_EQ(stream.ReadShape().sequence(), 1u);
  EXPECT_FALSE(stream.Read().has_value());
  ExpectError(stream.Finish(), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(StreamTest, UpdatesExtendTheSessionAndExpiryEndsTheStream) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  clock().Advance(std::chrono::minutes(40));
  stream.Update(1, Moved(1));
  stream.ReadShape();
  clock().Advance(std::chrono::minutes(40));
  stream.Update(2, Moved(2));
  stream.ReadShape();
  clock().Advance(std::chrono::minutes(61));
  stream.Update(3, Moved(3));
  EXPECT_FALSE(stream.Read().has_value());
  ExpectError(stream.Finish(), grpc::NOT_FOUND, "NOT_FOUND");
}

TEST_F(StreamTest, CancelledStreamIsForgotten) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  EXPECT_EQ(host().engine().streams.count(), 1u);
  {
    PoolGate gate(host().engine().interactive);
    stream.Update(1, Moved(1));
    stream.Ping(1);
    stream.Cancel();
  }
  EXPECT_EQ(stream.Finish().error_code(), grpc::CANCELLED);
  while (host().engine().streams.count() > 0) std::this_thread::yield();
  EXPECT_TRUE(Deform("s", "h", Moved(0)).ok());
}

TEST_F(StreamTest, FullQueueIsAnsweredInTheStream) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  v1::Handle wide = VertexHandle("w", 12);
  wide.set_area_radius(1.1);
  {
    PoolGate gate(host().engine().jobs);
    while (host().engine().jobs.TryPost([] {})) {
    }
    stream.Send(Edit(1, {}, {wide}));
    const v1::UpdateError error = stream.ReadError();
    EXPECT_EQ(error.sequence(), 1u);
    ExpectError(error.status(), grpc::RESOURCE_EXHAUSTED, "OVERLOADED");
  }
  while (host().engine().jobs.waiting() > 0) std::this_thread::yield();
  stream.Send(Edit(2, {}, {wide}));
  EXPECT_EQ(stream.ReadShape().sequence(), 2u);
}

TEST_F(StreamTest, FramesGoBeforeTheCallsOfOthers) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  std::promise<void> go;
  const auto call = [went = go.get_future().share()] { went.wait(); };
  {
    PoolGate gate(host().engine().interactive);
    while (host().engine().interactive.TryPost(call)) {
    }
    const std::size_t waiting = host().engine().interactive.waiting();
    stream.Update(1, Moved(1));
    while (host().engine().interactive.waiting() == waiting) std::this_thread::yield();
  }
  EXPECT_EQ(stream.ReadShape().sequence(), 1u) << "the queue is full, and no call has ended yet";
  go.set_value();
}

TEST_F(StreamTest, SlowReaderCostsOneFrameAndGetsTheNewest) {
  // Large shapes fill the connection's window; more updates than fit are then replaced, not stored.
  ASSERT_TRUE(Register("s", "large", Grid(200, 200)).ok());
  ASSERT_TRUE(Compile("s", "large", "l", {VertexHandle("a", 0)}).ok());
  DeformStream stream(deformation());
  stream.Opened("s", "l", v1::DELIVERY_LATEST);
  constexpr std::uint64_t kUpdates = 40;
  for (std::uint64_t i = 1; i <= kUpdates; ++i) {
    stream.Update(i, {TargetAt("a", static_cast<double>(i), 0)});
  }
  stream.HalfClose();
  ReadUntil(stream, kUpdates);
  EXPECT_FALSE(stream.Read().has_value());
  EXPECT_TRUE(stream.Finish().ok());
}

class StreamQuotaTest : public StreamTest {
 protected:
  void SetUp() override {
    options().limits.max_streams = 1;
    StreamTest::SetUp();
  }
};

TEST_F(StreamQuotaTest, OpenStreams) {
  DeformStream first(deformation());
  first.Opened("s", "h", v1::DELIVERY_LATEST);
  DeformStream second(deformation());
  EXPECT_FALSE(second.Read().has_value());
  const auto error = ExpectError(second.Finish(), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_streams");
  first.HalfClose();
  EXPECT_FALSE(first.Read().has_value());
  EXPECT_TRUE(first.Finish().ok());
  while (host().engine().streams.count() > 0) std::this_thread::yield();
  DeformStream third(deformation());
  third.Opened("s", "h", v1::DELIVERY_LATEST);
}

}  // namespace
}  // namespace arap::wire
