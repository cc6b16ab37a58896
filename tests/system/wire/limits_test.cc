// Every limit through the wire: refused by name with RESOURCE_EXHAUSTED and RetryInfo, and told by
// GetServerInfo.

#include <gmock/gmock.h>

#include "server/engine.h"
#include "tests/support/bounded.h"
#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

class LimitsTest : public WireTest {
 protected:
  std::vector<v1::HandleTarget> Targets() {
    return {TargetAt("a", 0, 0), TargetAt("b", 4, 0), TargetAt("c", 0, 4)};
  }
  void ExpectQuota(const grpc::Status& status, const char* quota) {
    const auto error = ExpectError(status, grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
    EXPECT_EQ(error.metadata.at("quota"), quota);
  }
};

TEST_F(LimitsTest, AreToldWithTheirNumbers) {
  Limits& limits = options().limits;
  limits.owner = {1, 2, 3, 4, 5};
  limits.max_bytes = 6;
  limits.max_registrations = 7;
  limits.max_compilations = 8;
  limits.max_flattenings = 9;
  limits.max_stream_fps = 10.5;
  limits.max_stream_idle = seconds(11);
  limits.max_stream_load = 0.5;
  limits.max_queued_jobs = 12;
  grpc::ClientContext context;
  v1::GetServerInfoResponse response;
  ASSERT_TRUE(server().GetServerInfo(&context, {}, &response).ok());
  const v1::Limits& told = response.limits();
  EXPECT_EQ(told.max_sessions_per_owner(), 1u);
  EXPECT_EQ(told.max_meshes_per_owner(), 2u);
  EXPECT_EQ(told.max_handle_sets_per_owner(), 3u);
  EXPECT_EQ(told.max_bytes_per_owner(), 4u);
  EXPECT_EQ(told.max_streams_per_owner(), 5u);
  EXPECT_EQ(told.max_bytes(), 6u);
  EXPECT_EQ(told.max_registrations(), 7u);
  EXPECT_EQ(told.max_compilations(), 8u);
  EXPECT_EQ(told.max_flattenings(), 9u);
  EXPECT_EQ(told.max_stream_fps(), 10.5);
  EXPECT_EQ(told.max_stream_idle().seconds(), 11);
  EXPECT_EQ(told.max_stream_load(), 0.5);
  EXPECT_EQ(told.max_queued_jobs(), 12u);
}

TEST_F(LimitsTest, OfTheOwner) {
  options().limits.owner.max_sessions = 2;
  options().limits.owner.max_meshes = 1;
  options().limits.owner.max_handle_sets = 1;
  SetUpCorners();
  ASSERT_TRUE(CreateSession("t").ok());
  ExpectQuota(CreateSession("u"), "max_sessions_per_owner");
  ExpectQuota(Register("t", "m", Grid(2, 2)), "max_meshes_per_owner");
  ExpectQuota(Compile("s", "m", "i", {VertexHandle("a", 0)}), "max_handle_sets_per_owner");
}

TEST_F(LimitsTest, Bytes) {
  options().limits.owner.max_bytes = 1 << 20;
  options().limits.max_bytes = 1 << 19;
  ASSERT_TRUE(CreateSession("s").ok());
  ExpectQuota(Register("s", "m", Grid(40, 40)), "max_bytes_per_owner");
  ExpectQuota(Register("s", "m", Grid(15, 15)), "max_bytes");
  EXPECT_TRUE(Register("s", "m", Grid(4, 4)).ok()) << "nothing was lost";
}

// What is wrong with a request is said also where there would be no room for it: the one never gets
// better.
TEST_F(LimitsTest, WhatIsAskedAmissIsSaidBeforeMemoryIsTaken) {
  options().limits.owner.max_bytes = 1 << 20;
  SetUpCorners();
  v1::RegisterMeshRequest request;
  request.set_session_id("s");
  *request.mutable_mesh() = Grid(40, 40);
  request.mutable_energy()->add_rigidity(1);
  v1::RegisterMeshResponse response;
  auto error = ExpectError(Call(&Deformation::RegisterMesh, request, &response),
                           grpc::INVALID_ARGUMENT, "ARRAY_LENGTH");
  EXPECT_EQ(error.fields, std::vector<std::string>{"energy.rigidity"});
  v1::Handle wide = VertexHandle("w", 0);
  wide.set_area_radius(std::numeric_limits<double>::infinity());
  std::vector<v1::Handle> handles(1'000, wide);
  for (std::size_t i = 0; i < handles.size(); ++i) {
    handles[i].set_handle_id("w" + std::to_string(i));
  }
  error = ExpectError(Compile("s", "m", "i", handles), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  EXPECT_EQ(error.fields, std::vector<std::string>{"handles[0].area_radius"});
}

TEST_F(LimitsTest, BytesOfAMessage) {
  options().limits.max_message_bytes = 2'000;
  SetUpCorners();
  auto error =
      ExpectError(Register("s", "n", Grid(10, 10)), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_message_bytes");
  EXPECT_EQ(error.metadata.at("limit"), "2000");
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_LATEST);
  stream.Update(1, {TargetAt(std::string(3'000, 'a'), 0, 0)});
  EXPECT_FALSE(stream.Read().has_value());
  error = ExpectError(stream.Finish(), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_message_bytes");
  grpc::ClientContext context;
  SetDeadline(context);
  v1::DeformTrackRequest track;
  track.set_session_id("s");
  track.set_handle_set_id(std::string(2'100, 'h'));
  const auto reader = deformation().DeformTrack(&context, track);
  v1::DeformTrackResponse frame;
  EXPECT_FALSE(reader->Read(&frame));
  error = ExpectError(reader->Finish(), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_message_bytes");
  EXPECT_EQ(Register("s", "n", Grid(20, 20)).error_code(), grpc::RESOURCE_EXHAUSTED)
      << "far beyond it is gRPC that refuses";
}

TEST_F(LimitsTest, JobsOfOneKind) {
  options().limits.max_registrations = 1;
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 8;
  SetUpCorners();
  PoolGate gate(host().engine().jobs);
  testing::BoundedThread first("the first registration",
                               [&] { EXPECT_TRUE(Register("s", "n", Grid(3, 3)).ok()); });
  ASSERT_TRUE(testing::Await("the registration has begun",
                             [&] { return host().engine().registrations.inside() > 0; }));
  ExpectQuota(Register("s", "o", Grid(3, 3)), "max_registrations");
  gate.Open();
  first.Join();
  EXPECT_TRUE(Register("s", "o", Grid(3, 3)).ok());
  EXPECT_EQ(host().engine().registrations.inside(), 0u);
}

TEST_F(LimitsTest, StreamsOfTheOwner) {
  options().limits.owner.max_streams = 1;
  SetUpCorners();
  DeformStream first(deformation());
  first.Opened("s", "h", v1::DELIVERY_LATEST);
  DeformStream second(deformation());
  EXPECT_FALSE(second.Read().has_value());
  ExpectQuota(second.Finish(), "max_streams_per_owner");
}

TEST_F(LimitsTest, FramesPerSecondAreAnsweredInTheStream) {
  options().limits.max_stream_fps = 3;
  SetUpCorners();
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  for (std::uint64_t i = 1; i <= 4; ++i) stream.Update(i, Targets());
  for (std::uint64_t i = 1; i <= 3; ++i) EXPECT_EQ(stream.ReadShape().sequence(), i);
  const v1::UpdateError error = stream.ReadError();
  EXPECT_EQ(error.sequence(), 4u);
  const auto decoded = ExpectError(error.status(), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(decoded.metadata.at("quota"), "max_stream_fps");
  clock().Advance(seconds(1));
  stream.Update(5, Targets());
  EXPECT_EQ(stream.ReadShape().sequence(), 5u) << "the stream goes on";
}

TEST_F(LimitsTest, StreamsThatWakeUpAreAdmittedAgain) {
  options().limits.max_stream_load = 1e-6;
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 16;
  SetUpCorners();
  DeformStream first(deformation()), second(deformation());
  for (DeformStream* stream : {&first, &second}) {
    v1::StreamDeformRequest open;
    open.mutable_open()->set_session_id("s");
    open.mutable_open()->set_handle_set_id("h");
    open.mutable_open()->mutable_options()->set_refine(10);
    stream->Send(open);
    ASSERT_TRUE(stream->Read()->has_opened()) << "who has sent nothing is no load";
  }
  first.Update(1, Targets());
  EXPECT_EQ(first.ReadShape().sequence(), 1u);

  second.Update(1, Targets());
  const v1::UpdateError error = second.ReadError();
  EXPECT_EQ(error.sequence(), 1u);
  const auto decoded = ExpectError(error.status(), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(decoded.metadata.at("quota"), "max_stream_load");
  EXPECT_EQ(decoded.metadata.at("floor_fps"), "30");
  EXPECT_FALSE(decoded.metadata.at("fits_frame_ms").empty());
  EXPECT_GT(decoded.retry_seconds, 0);
  EXPECT_NE(
      host().engine().metrics.Text().find("arapd_rejected_total{quota=\"max_stream_load\"} 1\n"),
      std::string::npos);

  clock().Advance(seconds(2));
  second.Update(2, Targets());
  EXPECT_EQ(second.ReadShape().sequence(), 2u) << "the first one sleeps";
}

TEST_F(LimitsTest, WhatStreamsHoldCountsInTheMemoryOfTheirOwner) {
  SetUpCorners();
  app::DerivedCache& memory = host().engine().derived;
  const std::size_t before = memory.bytes_of(app::kNobody);
  {
    DeformStream stream(deformation());
    stream.Opened("s", "h", v1::DELIVERY_EVERY);
    const std::size_t open = memory.bytes_of(app::kNobody);
    EXPECT_GT(open, before);
    v1::StreamDeformRequest edit;
    edit.mutable_edit()->set_sequence(1);
    *edit.mutable_edit()->add_add() = VertexHandle("added", 12);
    stream.Send(edit);
    EXPECT_EQ(stream.ReadShape().sequence(), 1u);
    EXPECT_GT(memory.bytes_of(app::kNobody), open);
    stream.HalfClose();
    EXPECT_FALSE(stream.Read().has_value());
    EXPECT_TRUE(stream.Finish().ok());
  }
  EXPECT_TRUE(testing::Await("the stream to be gone",
                             [&] { return memory.bytes_of(app::kNobody) == before; }));
}

TEST_F(LimitsTest, AStreamThatThereIsNoMemoryForIsRefused) {
  SetUpCorners();
  app::DerivedCache& memory = host().engine().derived;
  const auto rest = memory.Hold(app::kNobody, std::size_t{4} << 30u);
  DeformStream stream(deformation());
  v1::StreamDeformRequest open;
  open.mutable_open()->set_session_id("s");
  open.mutable_open()->set_handle_set_id("h");
  stream.Send(open);
  EXPECT_FALSE(stream.Read().has_value());
  const auto error = ExpectError(stream.Finish(), grpc::RESOURCE_EXHAUSTED, "LIMIT_EXCEEDED");
  EXPECT_EQ(error.metadata.at("quota"), "max_bytes_per_owner");
}

TEST_F(LimitsTest, IdleStreamsEnd) {
  SetUpCorners();
  DeformStream quiet(deformation()), alive(deformation());
  quiet.Opened("s", "h", v1::DELIVERY_LATEST);
  alive.Opened("s", "h", v1::DELIVERY_LATEST);
  clock().Advance(minutes(9));
  alive.Ping(1);
  clock().Advance(minutes(1));
  host().engine().streams.Sweep(clock().SteadyNow());
  EXPECT_FALSE(quiet.Read().has_value());
  const auto error = ExpectError(quiet.Finish(), grpc::ABORTED, "STREAM_IDLE");
  EXPECT_EQ(error.metadata.at("limit"), "600");
  alive.Ping(2);
}

TEST_F(LimitsTest, ATrackThatNobodyReadsEnds) {
  ASSERT_TRUE(CreateSession("s").ok());
  ASSERT_TRUE(Register("s", "large", Grid(150, 150)).ok());
  ASSERT_TRUE(Compile("s", "large", "h", {VertexHandle("a", 0)}).ok());
  v1::DeformTrackRequest track;
  track.set_session_id("s");
  track.set_handle_set_id("h");
  track.add_handle_ids("a");
  for (int i = 0; i < 50; ++i) {
    v1::TrackFrame& frame = *track.add_frames();
    frame.add_positions(i);
    frame.add_positions(0);
  }
  grpc::ClientContext context;
  SetDeadline(context);
  const auto reader = deformation().DeformTrack(&context, track);
  app::Engine& engine = host().engine();
  ASSERT_TRUE(testing::Await("the track runs", [&] { return engine.streams.count() == 1; }));
  EXPECT_TRUE(testing::Await("the track is cut off", [&] {
    clock().Advance(minutes(10));
    engine.streams.Sweep(clock().SteadyNow());
    return engine.streams.count() == 0;
  }));
  v1::DeformTrackResponse frame;
  while (reader->Read(&frame)) {
  }
  EXPECT_EQ(reader->Finish().error_code(), grpc::CANCELLED);
}

TEST_F(LimitsTest, WhatWasEvictedIsBuiltAgainOnTheJobLane) {
  options().lanes = {1, 1};
  options().limits.max_queued_jobs = 8;
  SetUpCorners();
  v1::DeformResponse before, after;
  ASSERT_TRUE(Deform("s", "h", Targets(), &before).ok());
  EXPECT_EQ(host().engine().derived.EvictIdle(seconds(0)), 2u);
  {
    PoolGate frames(host().engine().interactive);
    v1::GetHandleSetRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("h");
    v1::GetHandleSetResponse response;
    EXPECT_TRUE(Call(&Deformation::GetHandleSet, request, &response).ok());
    EXPECT_EQ(response.handle_set().revision(), 1u);
    host().engine().derived.EvictIdle(seconds(0));
    EXPECT_TRUE(Deform("s", "h", Targets(), &after).ok()) << "nothing of it on the lane of frames";
  }
  EXPECT_THAT(after.shape().positions(), ::testing::ElementsAreArray(before.shape().positions()));
  host().engine().derived.EvictIdle(seconds(0));
  DeformStream stream(deformation());
  stream.Opened("s", "h", v1::DELIVERY_EVERY);
  stream.Update(1, Targets());
  EXPECT_THAT(stream.ReadShape().positions(),
              ::testing::ElementsAreArray(before.shape().positions()));
}

}  // namespace
}  // namespace arap::wire
