// Compiling handles: every anchor, every fault, roles of components, hard handles that conflict.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>

#include "arap/core/pick.h"
#include "tests/core/deform/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

using ::testing::HasSubstr;

Handle AtPoint(std::string id, Complex position, Outside outside = Outside::kError) {
  Handle handle;
  handle.id = std::move(id);
  handle.anchor = PointAnchor{position};
  handle.outside = outside;
  return handle;
}

Fault CompileFault(const PlanarMesh& mesh, std::vector<Handle> handles) {
  const auto set = CompiledHandles::Compile(Register(mesh), std::move(handles));
  EXPECT_FALSE(set.has_value());
  return set ? Fault{} : set.error();
}

TEST(HandlesTest, AnchorsAreTheSamePlaceHoweverTheyAreSaid) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  const Complex centroid =
      (mesh.vertices[mesh.triangles[5][0]] + mesh.vertices[mesh.triangles[5][1]] +
       mesh.vertices[mesh.triangles[5][2]]) /
      3.0;
  const auto set = Compile(
      Register(mesh), {OnVertex("v", 7), AtPoint("p", mesh.vertices[7]),
                       InTriangle("t", 5, {1.0 / 3, 1.0 / 3, 1.0 / 3}), AtPoint("q", centroid)});
  EXPECT_LE(std::abs(set->handles()[0].rest - set->handles()[1].rest), 1e-12);
  EXPECT_LE(std::abs(set->handles()[2].rest - set->handles()[3].rest), 1e-12);
  EXPECT_EQ(set->Find("q"), 3u);
  EXPECT_FALSE(set->Find("nobody").has_value());
}

TEST(HandlesTest, BarycentricOrderIsTheClientsEvenWhenTheTriangleIsTurned) {
  PlanarMesh mesh = Grid(1, 1, 1, 1);
  const auto [a, b, c] = mesh.triangles[0];
  mesh.triangles[0] = {a, c, b};
  const auto set = Compile(Register(mesh), {InTriangle("h", 0, {0.5, 0.3, 0.2})});
  const Complex expected = 0.5 * mesh.vertices[a] + 0.3 * mesh.vertices[c] + 0.2 * mesh.vertices[b];
  EXPECT_LE(std::abs(set->handles()[0].rest - expected), 1e-12);
}

TEST(HandlesTest, NamesEveryFault) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  EXPECT_EQ(CompileFault(mesh, {OnVertex("a", 25)}).kind, FaultKind::kIndexOutOfRange);
  EXPECT_EQ(CompileFault(mesh, {InTriangle("a", 32, {1, 0, 0})}).kind, FaultKind::kIndexOutOfRange);
  EXPECT_EQ(CompileFault(mesh, {InTriangle("a", 0, {1, 1, -1})}).kind, FaultKind::kInvalidOption);
  const Fault twice = CompileFault(mesh, {OnVertex("a", 0), OnVertex("a", 1)});
  EXPECT_EQ(twice.kind, FaultKind::kDuplicateHandle);
  EXPECT_EQ(twice.field, "handles[1].handle_id");
  const Fault outside = CompileFault(mesh, {OnVertex("a", 0), AtPoint("b", {7, 2})});
  EXPECT_EQ(outside.kind, FaultKind::kHandleOutside);
  EXPECT_THAT(outside.message, HasSubstr("outside the mesh by 3"));
  Handle heavy = OnVertex("a", 0);
  heavy.weight = 1e13;
  EXPECT_EQ(CompileFault(mesh, {heavy}).kind, FaultKind::kInvalidOption);
  heavy.weight = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(CompileFault(mesh, {heavy}).kind, FaultKind::kInvalidOption);
}

TEST(HandlesTest, AHairOutsideCountsAsOnTheBorder) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);  // with a diagonal of 5.66
  const auto set = Compile(Register(mesh), {AtPoint("near", {4 + 5e-6, 2})});
  EXPECT_LE(std::abs(set->handles()[0].rest - Complex(4, 2)), 1e-12);
  EXPECT_EQ(set->handles()[0].snapped_distance, 0);
  EXPECT_TRUE(set->warnings().empty() || set->warnings()[0].kind != "snapped_handles");
  const Fault outside = CompileFault(mesh, {AtPoint("far", {4 + 6e-6, 2})});
  EXPECT_EQ(outside.kind, FaultKind::kHandleOutside);
  EXPECT_THAT(outside.message, HasSubstr("with snap"));
}

TEST(HandlesTest, EveryNumberIsWithinItsBounds) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Bad {
    std::string field, message;
    void (*spoil)(Handle&);
  };
  const Bad cases[] = {
      {"weight", " is 0, but must be finite, at least 1e-06, at most 1000000000000.",
       [](Handle& h) { h.weight = 0, h.hard = true; }},
      {"area_radius", " is inf, but must be finite, at least 0.",
       [](Handle& h) { h.area_radius = kInfinity; }},
      {"depth", " is -1e+31, but must be finite, at least -1e+30, at most 1e+30.",
       [](Handle& h) { h.depth = -1e31; }},
      {"depth_falloff", " is nan, but must be finite, at least 0.",
       [](Handle& h) { h.depth_falloff = kNan; }},
      {"position.y", " is inf, but must be finite.",
       [](Handle& h) {
         h.anchor = PointAnchor{{1, kInfinity}};
       }},
      {"triangle_point.barycentric", " has the weight -0.5, not between 0 and 1.",
       [](Handle& h) {
         h.anchor = TriangleAnchor{0, {0.75, 0.75, -0.5}};
       }},
      {"triangle_point.barycentric", " sums to 1.25, not to 1 within 1e-06.",
       [](Handle& h) {
         h.anchor = TriangleAnchor{0, {0.75, 0.25, 0.25}};
       }},
  };
  for (const Bad& bad : cases) {
    Handle handle = OnVertex("b", 1);
    bad.spoil(handle);
    const Fault fault = CompileFault(mesh, {OnVertex("a", 0), handle});
    EXPECT_EQ(fault.kind, FaultKind::kInvalidOption) << bad.field;
    EXPECT_EQ(fault.field, "handles[1]." + bad.field);
    EXPECT_EQ(fault.message, fault.field + bad.message);
    EXPECT_EQ(fault.elements, std::vector<std::uint32_t>{1}) << bad.field;
    ASSERT_EQ(fault.details.size(), 1u) << bad.field;
    EXPECT_EQ(fault.details[0].first, "value") << bad.field;
  }
}

TEST(HandlesTest, AnEditNamesWhatItAdds) {
  const auto set = Compile(Register(Grid(4, 4, 4, 4)), {OnVertex("a", 0)});
  const auto fault = [&](const Handle& handle) {
    return set->Edit({}, {OnVertex("b", 1), handle}).error();
  };
  Handle light = OnVertex("c", 2);
  light.weight = 0;
  EXPECT_EQ(fault(light).field, "add[1].weight");
  EXPECT_THAT(fault(light).message, HasSubstr("add[1].weight is 0"));
  EXPECT_EQ(fault(OnVertex("c", 99)).field, "add[1]");
  EXPECT_EQ(fault(AtPoint("c", {7, 0})).field, "add[1].position");
  EXPECT_EQ(fault(OnVertex("a", 2)).field, "add[1].handle_id");
}

TEST(HandlesTest, SnapsToTheBoundaryWhenAsked) {
  const auto set = Compile(Register(Grid(4, 4, 4, 4)), {AtPoint("b", {7, 2.25}, Outside::kSnap)});
  EXPECT_LE(std::abs(set->handles()[0].rest - Complex(4, 2.25)), 1e-12);
  EXPECT_NEAR(set->handles()[0].snapped_distance, 3, 1e-12);
  ASSERT_EQ(set->warnings().size(), 2u);  // and its component only translates
  EXPECT_EQ(set->warnings()[0].kind, "snapped_handles");
}

TEST(HandlesTest, ComponentsRestTranslateOrDeform) {
  const PlanarMesh mesh = TwoComponents(4, 4, 3);
  const auto registered = Register(mesh);
  const std::uint32_t other = 25;  // the first vertex of the second component
  // Nothing on either: everything rests, to the last bit.
  EXPECT_EQ(Deform(Compile(registered, {}), {}), mesh.vertices);
  // One handle on the second: it translates, the first rests.
  const auto one = Compile(registered, {OnVertex("a", other)});
  EXPECT_EQ(one->resting_components(), 1u);
  EXPECT_EQ(one->translating_components(), 1u);
  const auto moved = Deform(one, {{mesh.vertices[other] + Complex(2, 3), 0, 1}});
  for (std::size_t v = 0; v < moved.size(); ++v) {
    const Complex expected = mesh.vertices[v] + (v < other ? 0 : Complex(2, 3));
    EXPECT_LE(std::abs(moved[v] - expected), 1e-12);
  }
  // Coincident soft handles average, by weight.
  Handle light = OnVertex("b", other);
  light.weight = 1e6 / 3;
  const auto two = Compile(registered, {OnVertex("a", other), light});
  const auto averaged = Deform(
      two, {{mesh.vertices[other] + 4.0, 0, 1}, {mesh.vertices[other] + Complex(0, 4), 0, 1}});
  EXPECT_LE(std::abs(averaged[other + 3] - mesh.vertices[other + 3] - Complex(3, 1)), 1e-9);
}

TEST(HandlesTest, HardHandlesThatConflictAreNamed) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  std::vector<Handle> handles{OnVertex("a", 0), OnVertex("b", 0), OnVertex("c", 24)};
  for (Handle& h : handles) h.hard = true;
  const auto set = Compile(Register(mesh), handles);
  Deformer deformer(set);
  auto targets = set->RestTargets();
  ASSERT_TRUE(deformer.Update(targets).has_value());
  targets[0].position = targets[1].position = {-1, -1};
  const auto together = deformer.Update(targets);
  ASSERT_TRUE(together.has_value());
  EXPECT_LE(together->worst_handle_error, 1e-12);
  targets[1].position = {-1, -2};
  const std::vector<Complex> before(deformer.positions().begin(), deformer.positions().end());
  const auto conflict = deformer.Update(targets);
  ASSERT_FALSE(conflict.has_value());
  EXPECT_EQ(conflict.error().kind, FaultKind::kConflictingHandles);
  EXPECT_THAT(conflict.error().message, HasSubstr("\"b\""));
  EXPECT_TRUE(std::equal(before.begin(), before.end(), deformer.positions().begin()));
}

TEST(HandlesTest, FourHardPointsInATriangleConflictOnlyWhenTheyBend) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  std::vector<Handle> handles{
      InTriangle("a", 9, {0.8, 0.1, 0.1}), InTriangle("b", 9, {0.1, 0.8, 0.1}),
      InTriangle("c", 9, {0.1, 0.1, 0.8}), InTriangle("d", 9, {0.4, 0.3, 0.3})};
  for (Handle& h : handles) h.hard = true;
  const auto set = Compile(Register(mesh), handles);
  Deformer deformer(set);
  auto targets = set->RestTargets();
  for (Target& t : targets)
    t.position = Complex(1.5, 0.5) * t.position + 3.0;  // affine: consistent
  ASSERT_TRUE(deformer.Update(targets).has_value());
  targets[3].position += 0.1;
  EXPECT_EQ(deformer.Update(targets).error().kind, FaultKind::kConflictingHandles);
}

TEST(HandlesTest, HardHandlesAreMetExactly) {
  const PlanarMesh mesh = JitteredGrid(12, 12, 4);
  auto handles = RandomHandles(mesh, 7, 3);
  for (Handle& h : handles) h.hard = true;
  const auto set = Compile(Register(mesh), handles);
  ShapeQuality quality;
  Deform(set, RandomTargets(*set, 4, 9), {}, &quality);
  EXPECT_LE(quality.worst_handle_error, 1e-12 * Diagonal(mesh.vertices));
}

TEST(HandlesTest, OrientedAndAreaHandlesTurnAndScaleTheirPlace) {
  const PlanarMesh mesh = Grid(10, 10, 10, 10);
  Handle grip = AtPoint("grip", {5, 5});
  grip.hard = true;
  for (const double radius : {0.0, 1.5}) {
    grip.oriented = radius == 0;
    grip.area_radius = radius;
    const auto set = Compile(Register(mesh), {grip, OnVertex("corner", 0)});
    const Target target{{6, 5}, 0.5, 1.2};
    const auto shape = Deform(set, {target, {mesh.vertices[0], 0, 1}});
    std::size_t held = 0;
    for (std::size_t v = 0; v < shape.size(); ++v) {
      if (std::abs(mesh.vertices[v] - Complex(5, 5)) > std::max(radius, 1e-9)) continue;
      ++held;
      const Complex expected =
          target.position + std::polar(1.2, 0.5) * (mesh.vertices[v] - Complex(5, 5));
      EXPECT_LE(std::abs(shape[v] - expected), 1e-9);
    }
    EXPECT_EQ(held, radius == 0 ? 1u : 9u);
  }
}

TEST(HandlesTest, BadTargetsAreNamedAndNothingIsLost) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  const auto set = Compile(Register(mesh), {OnVertex("a", 0), OnVertex("b", 24)});
  Deformer deformer(set);
  auto targets = set->RestTargets();
  targets.pop_back();
  const auto fewer = deformer.Update(targets);
  EXPECT_EQ(fewer.error().kind, FaultKind::kTargetCount);
  EXPECT_THAT(fewer.error().message, HasSubstr("1 targets for 2 handles"));
  targets = set->RestTargets();
  targets[1].position = {std::numeric_limits<double>::quiet_NaN(), 0};
  const auto nan = deformer.Update(targets);
  EXPECT_EQ(nan.error().kind, FaultKind::kNonFiniteTarget);
  EXPECT_THAT(nan.error().message, HasSubstr("\"b\""));
  EXPECT_EQ(nan.error().field, "targets[1].x");
  targets = set->RestTargets();
  targets[0].scale = 2 * Target::kMaxScale;
  const auto large = deformer.Update(targets);
  EXPECT_EQ(large.error().kind, FaultKind::kInvalidOption);
  EXPECT_EQ(large.error().field, "targets[0].scale");
  EXPECT_EQ(deformer.Update(set->RestTargets(), {DeformMode::kRigid, 1001}).error().kind,
            FaultKind::kInvalidOption);
  EXPECT_TRUE(deformer.Update(set->RestTargets()).has_value());
}

TEST(HandlesTest, TargetsBeyondNumbersAreAFaultAndNotNaN) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  const auto set = Compile(Register(mesh), {OnVertex("a", 0), OnVertex("b", 24)});
  Deformer deformer(set);
  // Of 1e160 positions would be finite, and rotations 0.
  for (const double x : {1e308, 1e160}) {
    for (const std::uint32_t every : {0u, 1u}) {
      DeformOptions options;
      options.measure_every = every;
      const auto far = deformer.Update(std::vector<Target>{{x, 0, 1}, {-x, 0, 1}}, options);
      ASSERT_FALSE(far.has_value()) << x << " " << every;
      EXPECT_EQ(far.error().kind, FaultKind::kNumerical);
      EXPECT_TRUE(AllFinite(deformer.positions()));
    }
  }
}

TEST(HandlesTest, DepthFadesAndOrdersTheTriangles) {
  const PlanarMesh mesh = Grid(10, 1, 10, 1);
  Handle front = OnVertex("front", 0);
  front.depth = 5;
  front.depth_falloff = 4;
  const auto set = Compile(Register(mesh), {front, OnVertex("back", 10)});
  const auto depths = VertexDepths(*set);
  EXPECT_DOUBLE_EQ(depths[0], 5);
  EXPECT_DOUBLE_EQ(depths[2], 2.5);
  EXPECT_DOUBLE_EQ(depths[5], 0);
  const auto order = DrawOrder(*set);
  ASSERT_EQ(order.size(), mesh.triangles.size());
  EXPECT_LT(order.back(), 2u);  // the triangles of the first cell come last: in front
  EXPECT_TRUE(DrawOrder(*Compile(Register(mesh), {OnVertex("a", 0)})).empty());
}

TEST(HandlesTest, ABowtieIsWeldedAndTurnsAsOne) {
  const PlanarMesh bowtie{{{0, 0}, {-1, -1}, {-1, 1}, {1, -1}, {1, 1}}, {{0, 2, 1}, {0, 3, 4}}};
  const auto registered = Register(bowtie);
  const auto set = Compile(registered, {OnVertex("a", 1), OnVertex("b", 2)});
  const RigidMotion motion{0.8, {2, 1}};
  auto targets = set->RestTargets();
  for (Target& t : targets) t.position = motion(t.position);
  EXPECT_LE(MaxDistance(Deform(set, targets), Apply(motion, bowtie.vertices)), 1e-12);
}

}  // namespace
}  // namespace arap::testing
