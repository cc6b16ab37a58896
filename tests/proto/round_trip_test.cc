// What the model says survives the wire: every field, and the service's defaults for what a request
// leaves open.
#include <numbers>

#include <arap/v1/deformation_service.pb.h>
#include <arap/v1/flattening_service.pb.h>
#include <gmock/gmock.h>

#include "proto/convert/deform.h"
#include "proto/convert/flatten.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"

namespace arap::convert {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint32_t kMaxRefine = 1000;

TEST(RoundTrip, Meshes) {
  const PlanarMesh planar{{{0, 0}, {1, 0.5}, {-2, 3}}, {{0, 1, 2}}};
  v1::PlanarMesh flat;
  ToWire(planar, &flat);
  EXPECT_THAT(flat.vertices(), ElementsAre(0, 0, 1, 0.5, -2, 3));
  EXPECT_EQ(FromWire(flat, MeshLimits{}), planar);

  const SurfaceMesh surface{{{0, 0, 1}, {1, 0.5, 2}, {-2, 3, 4}}, {{2, 1, 0}}};
  v1::SurfaceMesh space;
  ToWire(surface, &space);
  EXPECT_EQ(FromWire(space, MeshLimits{}), surface);
}

TEST(RoundTrip, ArraysOfWrongLengthsAndLargeMeshesAreRefused) {
  v1::PlanarMesh mesh;
  mesh.add_vertices(1);
  const auto odd = FromWire(mesh, MeshLimits{});
  ASSERT_FALSE(odd);
  EXPECT_EQ(odd.error().kind, FaultKind::kArrayLength);
  EXPECT_EQ(odd.error().field, "mesh.vertices");
  mesh.add_vertices(1);
  mesh.add_vertices(1);
  mesh.add_vertices(1);
  const auto large = FromWire(mesh, MeshLimits{1, 1});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().kind, FaultKind::kMeshTooLarge);
  EXPECT_EQ(DetailOf(large.error(), "quota"), "max_vertices");
  EXPECT_EQ(DetailOf(large.error(), "limit"), "1");
}

TEST(RoundTrip, EnergyOptions) {
  for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace, Basis::kVertex}) {
    for (const Weights weights : {Weights::kUniform, Weights::kCotangent}) {
      const EnergyOptions energy{basis, weights, {1, 2.5}};
      v1::EnergyOptions out;
      ToWire(energy, &out);
      EXPECT_EQ(FromWire(out, EnergyOptions{}), energy);
    }
  }
  const EnergyOptions open{Basis::kFace, Weights::kCotangent, {}};
  EXPECT_EQ(FromWire(v1::EnergyOptions(), open), open);
  v1::EnergyOptions newer;
  newer.set_basis(static_cast<v1::Basis>(77));
  const auto unknown = FromWire(newer, EnergyOptions{});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().field, "energy.basis");
  EXPECT_EQ(DetailOf(unknown.error(), "value"), "77");
}

TEST(RoundTrip, Reports) {
  RegistrationReport report;
  report.vertices = 1;
  report.triangles = 2;
  report.edges = 3;
  report.components = 4;
  report.boundary_loops = 5;
  report.area = 6.5;
  report.diagonal = 7.5;
  report.warnings = {{"reversed_triangles", 3, {1, 2}, "3 triangles were turned round."}};
  report.bytes = 8;
  v1::MeshInfo out;
  ToWire(report, &out);
  EXPECT_EQ(ReportFromWire(out), report);
}

TEST(RoundTrip, Handles) {
  Handle handle;
  handle.id = "tail";
  handle.weight = 12;
  handle.hard = true;
  handle.oriented = true;
  handle.area_radius = 0.25;
  handle.outside = Outside::kSnap;
  handle.depth = -3;
  handle.depth_falloff = 4;
  const std::vector<decltype(Handle::anchor)> anchors{
      VertexAnchor{7}, TriangleAnchor{8, {0.5, 0.25, 0.25}}, PointAnchor{{1.5, -2}}};
  for (const auto& anchor : anchors) {
    handle.anchor = anchor;
    v1::Handle out;
    ToWire(handle, &out);
    EXPECT_EQ(FromWire(out, "handles[0]"), handle) << anchor.index();
  }
  const auto plain = FromWire(v1::Handle(), "handles[2]");
  ASSERT_FALSE(plain);
  EXPECT_EQ(plain.error().field, "handles[2]");
  v1::Handle vertex;
  vertex.set_vertex(0);
  EXPECT_EQ(FromWire(vertex, "h")->weight, Handle::kDefaultWeight);

  Handle tail;
  tail.id = "tail";
  const PlacedHandle placed{tail, {1, 2}, 0.5, 3};
  v1::HandleInfo info;
  ToWire(placed, &info);
  EXPECT_EQ(FromWire(info), placed);
}

TEST(RoundTrip, Targets) {
  const HandleTarget target{"tail", {{1, 2}, 0.5, 0}};
  v1::HandleTarget out;
  ToWire(target, &out);
  EXPECT_EQ(out.handle_id(), "tail");
  EXPECT_EQ(TargetFromWire(out), target.target) << "a scale of 0 is one";
  EXPECT_EQ(TargetFromWire(v1::HandleTarget()), Target());
}

TEST(RoundTrip, TrackFrames) {
  const std::vector<Target> turned{{{1, 2}, 0.5, 1}, {{3, 4}, 0, 2}};
  v1::TrackFrame frame;
  ToWire(turned, &frame);
  EXPECT_EQ(FromWire(frame, 2, "frames[0]"), turned);
  const std::vector<Target> plain{{{1, 2}}, {{3, 4}}};
  v1::TrackFrame brief;
  ToWire(plain, &brief);
  EXPECT_THAT(brief.angles_radians(), IsEmpty());
  EXPECT_THAT(brief.scales(), IsEmpty());
  EXPECT_EQ(FromWire(brief, 2, "frames[0]"), plain);
  const auto wrong = FromWire(frame, 3, "frames[4]");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().kind, FaultKind::kArrayLength);
  EXPECT_EQ(wrong.error().field, "frames[4].positions");
}

TEST(RoundTrip, DeformOptions) {
  for (const DeformMode mode :
       {DeformMode::kRigid, DeformMode::kSimilarity, DeformMode::kBaseline}) {
    for (const std::uint32_t every : {0u, 1u, 12u}) {
      const DeformOptions options{mode, 7, every};
      v1::DeformOptions out;
      ToWire(options, &out);
      EXPECT_EQ(FromWire(out, kMaxRefine), options);
      EXPECT_EQ(FromWire(out, 6).error().field, "options.refine");
    }
  }
  EXPECT_EQ(FromWire(v1::DeformOptions(), kMaxRefine), DeformOptions());
}

TEST(RoundTrip, QualitiesAndPicks) {
  const ShapeQuality quality{2, 0.5, 0, 1.5, 1.25, 3};
  v1::Shape shape;
  ToWire(quality, &shape);
  EXPECT_EQ(QualityFromWire(shape), quality);
  EXPECT_FALSE(shape.unmeasured());

  ShapeQuality unmeasured;
  unmeasured.measured = false;
  unmeasured.worst_handle_error = 0.5;
  v1::Shape other;
  ToWire(unmeasured, &other);
  EXPECT_TRUE(other.unmeasured());
  EXPECT_EQ(other.max_stretch(), 0) << "left out";
  EXPECT_EQ(QualityFromWire(other), unmeasured);

  const Pick pick{4, {0.5, 0.25, 0.25}, {1, 2}};
  v1::PickResult hit, miss;
  ToWire(pick, &hit);
  EXPECT_EQ(FromWire(hit), pick);
  ToWire(std::nullopt, &miss);
  EXPECT_EQ(FromWire(miss), std::nullopt);
}

TEST(RoundTrip, FlattenPresets) {
  for (const FlattenOptions& preset :
       {ArapOptions(), ArapOptions(Basis::kEdge), ArapOptions(Basis::kEdgeAsPublished),
        FirstStepOptions(), FirstStepOptions(Basis::kFace), LscmOptions(), AbfOptions()}) {
    v1::FlattenRequest request;
    ToWire(preset, &request);
    EXPECT_FALSE(request.has_refine()) << "left to the server";
    EXPECT_EQ(FromWire(request, kMaxRefine), preset);
    const auto frugal = FromWire(request, 5);
    ASSERT_TRUE(frugal);
    EXPECT_EQ(frugal->refine, std::min(preset.refine, 5));
  }
}

TEST(RoundTrip, FlattenOptions) {
  FlattenOptions options = ArapOptions(Basis::kEdge);
  options.energy.weights = Weights::kUniform;
  options.anchors = FlattenAnchors::kFarBoundary;
  options.refine = 3;
  options.refine_stop = 0.5;
  options.injective = true;
  options.cut.seams = {{0, 1}, {5, 2}};
  options.cut.auto_cut = true;
  options.cut.split_non_manifold = true;
  options.cut.tolerate_degenerate = true;
  options.pins = {{3, {1, -2}, 0.5}, {4, {0, 0}, 0}};
  for (const double degrees : {0.0, 30.0, 33.0, -45.5, 90.0, 123.456}) {
    options.grain_lines.push_back({1, 2, degrees * (std::numbers::pi / 180)});
  }
  v1::FlattenRequest request;
  ToWire(options, &request);
  EXPECT_EQ(FromWire(request, kMaxRefine), options);
}

TEST(RoundTrip, Drawings) {
  std::vector<DrawingOptions> drawings(3);
  drawings[0].millimetres_per_unit = 25.4;
  drawings[0].interior = true;
  drawings[1].format = DrawingFormat::kDxf;
  drawings[1].allowance = 12.5;
  drawings[1].corners = Corners::kSquare;
  drawings[1].notches = true;
  drawings[1].sheet_width = 1400;
  drawings[2].format = DrawingFormat::kPdf;
  drawings[2].corners = Corners::kRound;
  drawings[2].paper = "A3";
  drawings[2].overlap = 0;
  drawings[2].margin = 0;
  drawings[2].plain = true;
  const std::vector<NamedPart> parts{{0, "front"}, {7, ""}};
  v1::FlattenRequest request;
  ToWire(drawings, parts, &request);
  EXPECT_EQ(DrawingsFromWire(request), drawings);
  EXPECT_EQ(PartsFromWire(request), parts);
  // What is left open.
  request.clear_drawings();
  request.add_drawings()->set_format(v1::DRAWING_FORMAT_SVG);
  EXPECT_EQ(DrawingsFromWire(request), std::vector<DrawingOptions>(1));
  request.add_drawings();
  EXPECT_EQ(DrawingsFromWire(request).error().field, "drawings[1].format");

  v1::FlattenResponse response;
  ToWire({{{{"cover", "<svg>"}, {"1", std::string("\0\xff", 2)}}, {{"kind", 1, {2}, "A."}}}},
         &response);
  const std::vector<Drawing> back = DrawingsFromWire(response);
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].files[1], (DrawingFile{"1", std::string("\0\xff", 2)}));
  EXPECT_EQ(back[0].warnings[0].message, "A.");
}

// What a request of an older client leaves open.
TEST(FlattenDefaults, AreThoseOfTheMethod) {
  const std::pair<v1::FlattenMethod, FlattenOptions> methods[] = {
      {v1::FLATTEN_METHOD_UNSPECIFIED, ArapOptions()},
      {v1::FLATTEN_METHOD_ARAP_EDGE, ArapOptions(Basis::kEdge)},
      {v1::FLATTEN_METHOD_ARAP_FACE, ArapOptions()},
      {v1::FLATTEN_METHOD_LSCM, LscmOptions()},
      {v1::FLATTEN_METHOD_FIRST_STEP, FirstStepOptions()},
      {v1::FLATTEN_METHOD_ABF, AbfOptions()},
  };
  for (const auto& [method, preset] : methods) {
    v1::FlattenRequest request;
    request.set_method(method);
    EXPECT_EQ(FromWire(request, kMaxRefine), preset) << v1::FlattenMethod_Name(method);
  }
  EXPECT_EQ(ArapOptions().refine, kMaxFlattenRefine) << "until they have converged";
  EXPECT_EQ(ArapOptions().refine_stop, 3e-5);
  EXPECT_EQ(LscmOptions().refine, 0);
}

TEST(RoundTrip, Flattenings) {
  Flattening flat;
  flat.uv = {{0, 0}, {1, 0}, {0, 1}};
  flat.source = {0, 1, 2};
  flat.corner_uv = {{0, 1, 2}};
  flat.triangle_chart = {0};
  FlatChart chart;
  chart.loops = {{0, 1, 2}};
  chart.anchors = {1, 2};
  chart.triangles = 1;
  chart.distortion.arap_energy = 0.5;
  chart.crossings = 2;
  chart.refinements = 3;
  chart.refine_end = RefineEnd::kConverged;
  flat.charts = {chart};
  flat.first_step = {{0, 0}, {2, 0}, {0, 2}};
  flat.singular_values = {{1, -0.5}};
  flat.distortion = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  flat.overlaps = true;
  flat.cuts = {{0, 1}};
  flat.auto_cuts = 1;
  flat.degenerate = {4};
  flat.warnings = {{"cut", 1, {0}, "A cut."}};
  v1::FlattenRequest request;
  request.set_include_first_step(true);
  request.set_include_singular_values(true);
  for (const bool float64 : {false, true}) {
    request.set_float64(float64);
    v1::FlattenResponse response;
    ASSERT_TRUE(ToWire(flat, request, &response));
    EXPECT_THAT(response.anchor_vertices(), ElementsAre(1, 2));
    EXPECT_EQ(FromWire(response), flat);
    response.add_cut_edges(1);
    EXPECT_EQ(FromWire(response).error().kind, FaultKind::kInternal);
  }
}

TEST(RoundTrip, EndsOfRefinements) {
  Flattening flat;
  flat.uv = {{0, 0}};
  flat.source = {0};
  for (const auto end : {RefineEnd::kNotRefined, RefineEnd::kConverged, RefineEnd::kLimit}) {
    flat.charts.resize(1);
    flat.charts[0].refine_end = end;
    v1::FlattenResponse response;
    ASSERT_TRUE(ToWire(flat, {}, &response));
    EXPECT_EQ(FromWire(response)->charts[0].refine_end, end);
    // What a newer server may say.
    response.mutable_charts(0)->set_refine_end(static_cast<v1::RefineEnd>(77));
    EXPECT_EQ(FromWire(response)->charts[0].refine_end, RefineEnd::kNotRefined);
  }
}

TEST(RoundTrip, Times) {
  using std::chrono::nanoseconds;
  for (const nanoseconds time : {nanoseconds(0), nanoseconds(1'234'567'890), nanoseconds(-1)}) {
    google::protobuf::Duration duration;
    ToWire(time, &duration);
    EXPECT_EQ(FromWire(duration), time);
    google::protobuf::Timestamp stamp;
    ToWire(WallTime(time), &stamp);
    EXPECT_GE(stamp.nanos(), 0);
    EXPECT_EQ(FromWire(stamp), WallTime(time));
  }
}

}  // namespace
}  // namespace arap::convert
