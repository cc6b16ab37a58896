// Deform and DeformTrack over the wire.
#include <algorithm>
#include <limits>
#include <utility>

#include "tests/system/wire/wire_fixture.h"

namespace arap::wire {
namespace {

class DeformTest : public WireTest {
 protected:
  void SetUp() override { SetUpCorners(); }

  // The corners moved by (dx, dy).
  static std::vector<v1::HandleTarget> Moved(double dx, double dy) {
    return {TargetAt("a", dx, dy), TargetAt("b", 4 + dx, dy), TargetAt("c", dx, 4 + dy)};
  }

  grpc::Status DeformWith(const v1::DeformRequest& request, v1::DeformResponse* response) {
    return Call(&Deformation::Deform, request, response);
  }

  static v1::DeformRequest Request(const std::vector<v1::HandleTarget>& targets) {
    v1::DeformRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("h");
    request.mutable_targets()->Assign(targets.begin(), targets.end());
    return request;
  }
};

TEST_F(DeformTest, MovedHandlesMoveTheMesh) {
  v1::DeformResponse response;
  ASSERT_TRUE(Deform("s", "h", Moved(10, -3), &response).ok());
  const v1::Shape& shape = response.shape();
  const v1::PlanarMesh rest = Grid(4, 4);
  ASSERT_EQ(shape.positions_size(), rest.vertices_size());
  EXPECT_EQ(shape.positions64_size(), 0);
  for (int i = 0; i < rest.vertices_size(); i += 2) {
    EXPECT_NEAR(shape.positions(i), rest.vertices(i) + 10, 1e-4);
    EXPECT_NEAR(shape.positions(i + 1), rest.vertices(i + 1) - 3, 1e-4);
  }
  EXPECT_EQ(shape.flipped_count(), 0u);
  EXPECT_LT(shape.worst_handle_error(), 1e-4);
  EXPECT_NEAR(shape.mean_stretch(), 1, 1e-6);
  EXPECT_NEAR(shape.max_stretch(), 1, 1e-6);
  EXPECT_NEAR(shape.energy(), 0, 1e-8);
  EXPECT_EQ(shape.handle_set_revision(), 1u);
  EXPECT_GT(shape.solve_micros(), 0);
  EXPECT_GT(shape.queue_micros(), 0);
}

TEST_F(DeformTest, OrderOfTargetsDoesNotMatter) {
  auto targets = Moved(1, 2);
  targets[1].set_x(6);
  v1::DeformResponse one;
  v1::DeformResponse other;
  ASSERT_TRUE(Deform("s", "h", targets, &one).ok());
  std::swap(targets[0], targets[2]);
  ASSERT_TRUE(Deform("s", "h", targets, &other).ok());
  EXPECT_TRUE(std::equal(one.shape().positions().begin(), one.shape().positions().end(),
                         other.shape().positions().begin()));
  EXPECT_EQ(one.shape().worst_handle_id(), other.shape().worst_handle_id());
}

TEST_F(DeformTest, DoublePrecisionOnRequest) {
  auto request = Request(Moved(1e-9, 0));
  request.mutable_options()->set_float64(true);
  v1::DeformResponse response;
  ASSERT_TRUE(DeformWith(request, &response).ok());
  EXPECT_EQ(response.shape().positions_size(), 0);
  ASSERT_EQ(response.shape().positions64_size(), 50);
  EXPECT_NEAR(response.shape().positions64(2), 1 + 1e-9, 1e-11);
}

TEST_F(DeformTest, FlippedTrianglesAreCountedAndNamed) {
  auto request = Request({TargetAt("a", 4, 0), TargetAt("b", 0, 0), TargetAt("c", 4, 4)});
  request.mutable_options()->set_mode(v1::DEFORM_MODE_BASELINE);
  request.mutable_options()->set_include_flipped_ids(true);
  v1::DeformResponse response;
  ASSERT_TRUE(DeformWith(request, &response).ok());
  EXPECT_EQ(response.shape().flipped_count(),
            static_cast<std::uint64_t>(response.shape().flipped_ids_size()));
  EXPECT_GT(response.shape().max_stretch(), 1);
}

TEST_F(DeformTest, EveryModeAndRefinementAnswers) {
  for (const v1::DeformMode mode : {v1::DEFORM_MODE_UNSPECIFIED, v1::DEFORM_MODE_RIGID,
                                    v1::DEFORM_MODE_SIMILARITY, v1::DEFORM_MODE_BASELINE}) {
    auto request = Request(Moved(1, 1));
    request.mutable_options()->set_mode(mode);
    request.mutable_options()->set_refine(3);
    v1::DeformResponse response;
    EXPECT_TRUE(DeformWith(request, &response).ok()) << mode;
  }
}

TEST_F(DeformTest, MissingTargetsAreNamed) {
  const auto error =
      ExpectError(Deform("s", "h", {TargetAt("b", 0, 0)}), grpc::INVALID_ARGUMENT, "TARGET_COUNT");
  EXPECT_EQ(error.metadata.at("count"), "1");
  EXPECT_EQ(error.metadata.at("expected"), "3");
  EXPECT_EQ(error.metadata.at("missing"), "a, c");
  EXPECT_EQ(error.metadata.at("elements"), "0,2");
  EXPECT_NE(error.message.find("a, c"), std::string::npos);
  EXPECT_TRUE(Deform("s", "h", Moved(0, 0)).ok());
}

TEST_F(DeformTest, UnknownAndRepeatedHandlesAreNamed) {
  auto targets = Moved(0, 0);
  targets[1].set_handle_id("nobody");
  auto error = ExpectError(Deform("s", "h", targets), grpc::NOT_FOUND, "UNKNOWN_HANDLE");
  EXPECT_EQ(error.metadata.at("handle_id"), "nobody");
  EXPECT_EQ(error.fields, std::vector<std::string>{"targets[1].handle_id"});
  targets[1].set_handle_id("a");
  error = ExpectError(Deform("s", "h", targets), grpc::INVALID_ARGUMENT, "DUPLICATE_HANDLE");
  EXPECT_EQ(error.metadata.at("handle_id"), "a");
}

TEST_F(DeformTest, EndlessNamesDoNotBreakTheStatus) {
  auto targets = Moved(0, 0);
  targets[0].set_handle_id(std::string(100'000, 'x'));
  ExpectError(Deform("s", "h", targets), grpc::NOT_FOUND, "UNKNOWN_HANDLE");
  ExpectError(CreateSession(std::string(100'000, '\n')), grpc::INVALID_ARGUMENT, "INVALID_NAME");
}

TEST_F(DeformTest, TargetsMustBeFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    auto targets = Moved(0, 0);
    targets[2].set_y(bad);
    const auto error =
        ExpectError(Deform("s", "h", targets), grpc::INVALID_ARGUMENT, "NON_FINITE_TARGET");
    EXPECT_EQ(error.fields, std::vector<std::string>{"targets[2].y"});
    EXPECT_EQ(error.metadata.at("elements"), "2");
  }
  auto targets = Moved(0, 0);
  targets[0].set_scale(-1);
  ExpectError(Deform("s", "h", targets), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
}

TEST_F(DeformTest, ResultBeyondFloatIsRefusedNotSent) {
  ExpectError(Deform("s", "h", Moved(1e39, 0)), grpc::INTERNAL, "NUMERICAL");
  auto request = Request(Moved(1e39, 0));
  request.mutable_options()->set_float64(true);
  v1::DeformResponse response;
  ASSERT_TRUE(DeformWith(request, &response).ok());
  EXPECT_NEAR(response.shape().positions64(0), 1e39, 1e30);
}

TEST_F(DeformTest, HardHandlesThatContradictAreNamed) {
  v1::Handle first = VertexHandle("p", 6);
  v1::Handle second = VertexHandle("q", 6);
  first.set_hard(true);
  second.set_hard(true);
  ASSERT_TRUE(Compile("s", "m", "hard", {first, second}).ok());
  const auto error = ExpectError(Deform("s", "hard", {TargetAt("p", 0, 0), TargetAt("q", 3, 0)}),
                                 grpc::INVALID_ARGUMENT, "CONFLICTING_HANDLES");
  EXPECT_FALSE(error.metadata.at("elements").empty());
  EXPECT_TRUE(Deform("s", "hard", {TargetAt("p", 3, 0), TargetAt("q", 3, 0)}).ok());
}

TEST_F(DeformTest, OptionsHaveRanges) {
  auto request = Request(Moved(0, 0));
  request.mutable_options()->set_refine(1001);
  v1::DeformResponse response;
  auto error =
      ExpectError(DeformWith(request, &response), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
  EXPECT_EQ(error.metadata.at("quota"), "max_refine");
  EXPECT_EQ(error.metadata.at("limit"), "1000");
  request.mutable_options()->set_refine(0);
  request.mutable_options()->set_mode(static_cast<v1::DeformMode>(55));
  ExpectError(DeformWith(request, &response), grpc::INVALID_ARGUMENT, "INVALID_OPTION");
}

TEST_F(DeformTest, PicksMapDeformedPointsBackToRest) {
  auto request = Request(Moved(2, 1));  // a translation: rest is two and one back
  for (const double value : {3.25, 2.75, 100.0, 100.0}) request.add_pick_points(value);
  v1::DeformResponse response;
  ASSERT_TRUE(DeformWith(request, &response).ok());
  ASSERT_EQ(response.shape().picks_size(), 2);
  const v1::PickResult& hit = response.shape().picks(0);
  EXPECT_TRUE(hit.hit());
  EXPECT_NEAR(hit.rest().x(), 1.25, 1e-9);
  EXPECT_NEAR(hit.rest().y(), 1.75, 1e-9);
  ASSERT_EQ(hit.barycentric_size(), 3);
  EXPECT_NEAR(hit.barycentric(0) + hit.barycentric(1) + hit.barycentric(2), 1, 1e-12);
  EXPECT_FALSE(response.shape().picks(1).hit());
}

TEST_F(DeformTest, BadPicksAreNamed) {
  auto request = Request(Moved(0, 0));
  request.add_pick_points(1);
  v1::DeformResponse response;
  ExpectError(DeformWith(request, &response), grpc::INVALID_ARGUMENT, "ARRAY_LENGTH");
  request.add_pick_points(std::nan(""));
  ExpectError(DeformWith(request, &response), grpc::INVALID_ARGUMENT, "NON_FINITE_TARGET");
  request.mutable_pick_points()->Resize(2 * 1025, 0);
  ExpectError(DeformWith(request, &response), grpc::INVALID_ARGUMENT, "ARRAY_LENGTH");
}

class TrackTest : public DeformTest {
 protected:
  // The corners on their way along the diagonal.
  static v1::DeformTrackRequest Track(int frames) {
    v1::DeformTrackRequest request;
    request.set_session_id("s");
    request.set_handle_set_id("h");
    for (const char* id : {"c", "a", "b"}) request.add_handle_ids(id);
    for (int i = 0; i < frames; ++i) {
      v1::TrackFrame& frame = *request.add_frames();
      for (const double value : {0.0, 4.0, 0.0, 0.0, 4.0, 0.0}) frame.add_positions(value + i);
    }
    return request;
  }

  // The frames that came, and the status at the end.
  std::pair<std::vector<v1::Shape>, grpc::Status> Run(const v1::DeformTrackRequest& request) {
    grpc::ClientContext context;
    SetDeadline(context);
    auto reader = deformation().DeformTrack(&context, request);
    std::vector<v1::Shape> shapes;
    for (v1::DeformTrackResponse response; reader->Read(&response);) {
      shapes.push_back(response.shape());
    }
    return {std::move(shapes), reader->Finish()};
  }

  WireError Refused(const v1::DeformTrackRequest& request, const char* reason) {
    const auto [shapes, status] = Run(request);
    EXPECT_TRUE(shapes.empty());
    return ExpectError(status, grpc::INVALID_ARGUMENT, reason);
  }
};

TEST_F(TrackTest, FramesComeInOrder) {
  const auto [shapes, status] = Run(Track(20));
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(shapes.size(), 20u);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    EXPECT_EQ(shapes[i].sequence(), i);
    EXPECT_NEAR(shapes[i].positions(0), static_cast<double>(i), 1e-4);
    EXPECT_NEAR(shapes[i].positions(1), static_cast<double>(i), 1e-4);
    EXPECT_GT(shapes[i].solve_micros(), 0);
  }
}

TEST_F(TrackTest, FramesEqualSingleDeformations) {
  v1::DeformTrackRequest request = Track(1);
  request.mutable_frames(0)->set_positions(0, 1.5);
  const auto [shapes, status] = Run(request);
  ASSERT_TRUE(status.ok());
  v1::DeformResponse single;
  ASSERT_TRUE(
      Deform("s", "h", {TargetAt("a", 0, 0), TargetAt("b", 4, 0), TargetAt("c", 1.5, 4)}, &single)
          .ok());
  EXPECT_TRUE(std::equal(shapes[0].positions().begin(), shapes[0].positions().end(),
                         single.shape().positions().begin()));
}

TEST_F(TrackTest, NoFramesAreATrack) {
  const auto [shapes, status] = Run(Track(0));
  EXPECT_TRUE(status.ok());
  EXPECT_TRUE(shapes.empty());
}

TEST_F(TrackTest, BadFrameIsNamedBeforeTheFirstIsAnswered) {
  v1::DeformTrackRequest request = Track(5);
  request.mutable_frames(3)->set_positions(1, std::numeric_limits<double>::quiet_NaN());
  auto error = Refused(request, "NON_FINITE_TARGET");
  EXPECT_NE(error.message.find("frames[3]"), std::string::npos);
  request = Track(5);
  request.mutable_frames(4)->add_positions(1);
  error = Refused(request, "ARRAY_LENGTH");
  EXPECT_EQ(error.fields, std::vector<std::string>{"frames[4].positions"});
  request = Track(5);
  request.mutable_frames(2)->add_angles_radians(1);
  error = Refused(request, "ARRAY_LENGTH");
  EXPECT_EQ(error.fields, std::vector<std::string>{"frames[2].angles_radians"});
}

TEST_F(TrackTest, ColumnsAreEveryHandleOnce) {
  v1::DeformTrackRequest request = Track(1);
  request.mutable_handle_ids()->RemoveLast();
  auto error = Refused(request, "TARGET_COUNT");
  EXPECT_EQ(error.metadata.at("missing"), "b");
  request.add_handle_ids("a");
  Refused(request, "DUPLICATE_HANDLE");
  request.set_handle_ids(2, "nobody");
  const auto [shapes, status] = Run(request);
  ExpectError(status, grpc::NOT_FOUND, "UNKNOWN_HANDLE");
}

class TrackQuotaTest : public TrackTest {
 protected:
  void SetUp() override {
    options().limits.max_track_frames = 2;
    TrackTest::SetUp();
  }
};

TEST_F(TrackQuotaTest, FramesOfOneTrack) {
  EXPECT_TRUE(Run(Track(2)).second.ok());
  const auto error = Refused(Track(3), "INVALID_OPTION");
  EXPECT_EQ(error.metadata.at("quota"), "max_track_frames");
  EXPECT_EQ(error.metadata.at("limit"), "2");
}

}  // namespace
}  // namespace arap::wire
