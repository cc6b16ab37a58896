// Edits of a stream: its own handle set changes, the one of the session does not.
#include "tests/system/wire/stream_fixture.h"

namespace arap::wire {
namespace {

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
  const auto radius =
      ExpectError(stream.ReadError().status(), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  EXPECT_EQ(radius.fields, std::vector<std::string>{"add[0].area_radius"});
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

}  // namespace
}  // namespace arap::wire
