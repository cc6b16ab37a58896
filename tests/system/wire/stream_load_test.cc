// Streams on a server that is full.
#include <cmath>
#include <cstring>
#include <future>
#include <string>
#include <vector>

#include "arap/core/deformer.h"
#include "arap/core/registered_mesh.h"
#include "proto/convert/mesh.h"
#include "tests/support/bounded.h"
#include "tests/support/poses.h"
#include "tests/system/wire/stream_fixture.h"

namespace arap::wire {
namespace {

TEST_F(StreamTest, FullQueueIsAnsweredInTheStream) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  v1::Handle wide = VertexHandle("w", 12);
  wide.set_area_radius(1.1);
  {
    PoolGate gate(host().engine().jobs);
    while (host().engine().jobs.TryPost([] {}, {app::kNobody})) {
    }
    stream.Send(Edit(1, {}, {wide}));
    const v1::UpdateError error = stream.ReadError();
    EXPECT_EQ(error.sequence(), 1u);
    ExpectError(error.status(), grpc::RESOURCE_EXHAUSTED, "OVERLOADED");
  }
  ASSERT_TRUE(
      testing::Await("the lane is empty", [&] { return host().engine().jobs.waiting() == 0; }));
  stream.Send(Edit(2, {}, {wide}));
  EXPECT_EQ(stream.ReadShape().sequence(), 2u);
}

TEST_F(StreamTest, FramesGoBeforeTheCallsOfOthers) {
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  std::promise<void> go;
  const auto call = [went = go.get_future().share()] {
    EXPECT_EQ(went.wait_for(testing::kLongest), std::future_status::ready) << "the test goes on";
  };
  {
    PoolGate gate(host().engine().interactive);
    // Calls that are expected to take 20 ms, as those of others are: turns go by what work takes.
    while (host().engine().interactive.TryPost(call, {"others", 0, 0.02})) {
    }
    const std::size_t waiting = host().engine().interactive.waiting();
    stream.Update(1, Moved(1));
    ASSERT_TRUE(testing::Await("the update waits",
                               [&] { return host().engine().interactive.waiting() > waiting; }));
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

// Two streams of a mesh that is large enough to share passes, on a server with one worker.
class SharedPassTest : public StreamTest {
 protected:
  void SetUp() override {
    options().limits.max_stream_load = 0;  // two such streams are more than a worker is meant for
    StreamTest::SetUp();
    ASSERT_TRUE(Register("s", "large", Grid(200, 200)).ok());
    ASSERT_TRUE(Compile("s", "large", "one", {VertexHandle("a", 0), VertexHandle("b", 7)}).ok());
    ASSERT_TRUE(Compile("s", "large", "other", {VertexHandle("a", 9), VertexHandle("b", 0)}).ok());
  }

  // Frames with a refinement: they are expected to take more than what is short.
  static void Open(DeformStream& stream, const char* set, v1::Delivery delivery) {
    v1::StreamDeformRequest request;
    request.mutable_open()->set_session_id("s");
    request.mutable_open()->set_handle_set_id(set);
    request.mutable_open()->set_delivery(delivery);
    request.mutable_open()->mutable_options()->set_refine(1);
    stream.Send(request);
    const auto answer = stream.Read();
    EXPECT_TRUE(answer && answer->has_opened());
  }

  // What both are asked for is waiting before the worker is free.
  void BothWait(DeformStream& one, double x, DeformStream& other, double y) {
    runtime::WorkerPool& frames = host().engine().interactive;
    PoolGate gate(frames);
    ++round_;
    one.Update(round_, {TargetAt("a", x, 1), TargetAt("b", 30, 2)});
    other.Update(round_, {TargetAt("a", 3, y), TargetAt("b", 5, 2)});
    EXPECT_TRUE(testing::Await("both wait", [&] { return frames.waiting() == 2; }));
  }

  std::uint64_t taken_along() { return host().engine().interactive.stats().taken_along; }

  // Without what is measured anew every time.
  static std::string Bytes(v1::Shape shape) {
    shape.clear_sequence();
    shape.clear_queue_micros();
    shape.clear_solve_micros();
    return shape.SerializeAsString();
  }

  std::uint64_t round_ = 0;
};

TEST_F(SharedPassTest, GivesEachStreamTheShapeThatItHasAlone) {
  DeformStream one(deformation()), other(deformation());
  Open(one, "one", v1::DELIVERY_EVERY);
  Open(other, "other", v1::DELIVERY_LATEST);
  BothWait(one, 4, other, 6);
  const std::string together = Bytes(one.ReadShape()), beside = Bytes(other.ReadShape());
  EXPECT_EQ(taken_along(), 1u);
  EXPECT_EQ(host().engine().interactive.waiting(), 0u);

  one.Update(2, {TargetAt("a", 4, 1)});
  EXPECT_EQ(Bytes(one.ReadShape()), together);
  other.Update(2, {TargetAt("a", 3, 6)});
  EXPECT_EQ(Bytes(other.ReadShape()), beside);
  EXPECT_EQ(taken_along(), 1u) << "nobody waited";
}

TEST_F(SharedPassTest, WhatHappensToOneIsNothingToTheOther) {
  DeformStream one(deformation()), other(deformation());
  Open(one, "one", v1::DELIVERY_EVERY);
  Open(other, "other", v1::DELIVERY_EVERY);
  BothWait(one, 1e308, other, 6);
  ExpectError(one.ReadError().status(), grpc::INTERNAL, "NUMERICAL");
  EXPECT_EQ(other.ReadShape().sequence(), 1u);
  EXPECT_EQ(taken_along(), 1u);
  {
    DeformStream leaving(deformation());
    Open(leaving, "one", v1::DELIVERY_EVERY);
    runtime::WorkerPool& frames = host().engine().interactive;
    PoolGate gate(frames);
    other.Update(2, {TargetAt("a", 3, 7)});
    EXPECT_TRUE(testing::Await("one waits", [&] { return frames.waiting() == 1; }));
    leaving.Update(1, {TargetAt("a", 2, 2)});
    EXPECT_TRUE(testing::Await("both wait", [&] { return frames.waiting() == 2; }));
    leaving.Cancel();
  }
  EXPECT_EQ(other.ReadShape().sequence(), 2u);
  EXPECT_TRUE(
      testing::Await("the stream is gone", [&] { return host().engine().streams.count() == 2; }));
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
  ASSERT_TRUE(
      testing::Await("the stream is gone", [&] { return host().engine().streams.count() == 0; }));
  DeformStream third(deformation());
  third.Opened("s", "h", v1::DELIVERY_LATEST);
}

// An update that is a job for its length, here for many refinements; other workers may take parts of it.
class LongFrameTest : public WireTest, public ::testing::WithParamInterface<std::size_t> {};

TEST_P(LongFrameTest, HasTheBytesOfOneThread) {
  options().lanes = {GetParam(), 1};
  const v1::PlanarMesh grid = Grid(140, 140);
  ASSERT_TRUE(CreateSession("s").ok());
  ASSERT_TRUE(Register("s", "m", grid).ok());
  ASSERT_TRUE(Compile("s", "m", "h", {VertexHandle("a", 0), VertexHandle("b", 9'000)}).ok());
  DeformStream stream(deformation());
  v1::StreamDeformRequest request;
  request.mutable_open()->set_session_id("s");
  request.mutable_open()->set_handle_set_id("h");
  request.mutable_open()->set_delivery(v1::DELIVERY_EVERY);
  request.mutable_open()->mutable_options()->set_refine(40);
  request.mutable_open()->mutable_options()->set_float64(true);
  stream.Send(request);
  const auto opened = stream.Read();
  ASSERT_TRUE(opened && opened->has_opened());
  const runtime::WorkerPool& jobs = host().engine().jobs;
  ASSERT_TRUE(testing::Await("no job is there", [&] { return jobs.stats().running == 0; }));
  const std::uint64_t before = jobs.stats().completed;
  stream.Update(1, {TargetAt("a", 3, 7), TargetAt("b", 60, 90)});
  const v1::Shape shape = stream.ReadShape();
  EXPECT_TRUE(
      testing::Await("the frame was a job", [&] { return jobs.stats().completed > before; }));

  const auto mesh = convert::FromWire(grid, MeshLimits{});
  ASSERT_TRUE(mesh.has_value());
  const auto set =
      CompiledHandles::Compile(*RegisteredMesh::Register(*mesh, {}),
                               {testing::AtVertex("a", 0), testing::AtVertex("b", 9'000)});
  ASSERT_TRUE(set.has_value());
  Deformer deformer(*set);
  const Target targets[] = {{{3, 7}}, {{60, 90}}};
  const auto quality = deformer.Update(targets, {DeformMode::kRigid, 40});
  ASSERT_TRUE(quality.has_value());
  EXPECT_EQ(shape.energy(), quality->energy);
  EXPECT_EQ(shape.mean_stretch(), quality->mean_stretch);
  ASSERT_EQ(static_cast<std::size_t>(shape.positions64_size()), 2 * deformer.positions().size());
  EXPECT_EQ(std::memcmp(shape.positions64().data(), deformer.positions().data(),
                        deformer.positions().size_bytes()),
            0);
}

INSTANTIATE_TEST_SUITE_P(Workers, LongFrameTest, ::testing::Values(1u, 2u, 4u));

}  // namespace
}  // namespace arap::wire
