// What can be asked of a flattening: pins, grain lines, charts, cuts, left-out triangles, layouts
// without flips, prepared surfaces.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "arap/core/flattener.h"
#include "core/mesh/space.h"
#include "tests/core/property/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

FlattenOptions Refined() {
  FlattenOptions options;
  options.refine = 20;
  options.refine_stop = 1e-6;
  return options;
}

// What every answer must keep, whatever was asked.
void CheckSound(const SurfaceMesh& mesh, const Flattening& flat) {
  ASSERT_EQ(flat.corner_uv.size(), mesh.triangles.size());
  ASSERT_EQ(flat.source.size(), flat.uv.size());
  ASSERT_EQ(flat.singular_values.size(), mesh.triangles.size());
  ASSERT_GE(flat.uv.size(), mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_EQ(flat.source[v], v);
  for (const Complex p : flat.uv) {
    ASSERT_TRUE(std::isfinite(p.real()) && std::isfinite(p.imag()));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      ASSERT_EQ(flat.source[flat.corner_uv[t][k]], mesh.triangles[t][k]);
    }
  }
  std::size_t triangles = 0;
  for (const FlatChart& chart : flat.charts) {
    triangles += chart.triangles;
    EXPECT_FALSE(chart.loops.empty());
  }
  EXPECT_EQ(triangles, mesh.triangles.size());
}

TEST(FlattenOptionsTest, EveryMethodIsExactOnDevelopables) {
  const Developable made = ConePatch(30, 10, 1, 3, 4.4, 5.9, 3);
  for (const auto method : {FlattenMethod::kArap, FlattenMethod::kFirstStep, FlattenMethod::kAbf}) {
    for (const auto anchors :
         {FlattenAnchors::kCentreEdge, FlattenAnchors::kFarBoundary, FlattenAnchors::kSpectral}) {
      // Of all anchors the distance of two far vertices is not what it is in the plane: the shape
      // is exact up to its scale then.
      FlattenOptions options;
      options.method = method;
      options.anchors = anchors;
      const Flattening flat = Must(Flatten(made.surface, options));
      CheckSound(made.surface, flat);
      if (method != FlattenMethod::kArap && anchors == FlattenAnchors::kFarBoundary) continue;
      EXPECT_LE(RelativeDistanceUpToMotion(flat.uv, made.flat), 1e-8)
          << static_cast<int>(method) << ' ' << static_cast<int>(anchors);
      EXPECT_NEAR(flat.distortion.area_ratio, 1, 1e-8);
    }
  }
}

TEST(FlattenOptionsTest, HardPinsAreMetExactly) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  FlattenOptions options = Refined();
  options.pins = {{3, {10, 20}, 0}, {50, {11, 20.5}, 0}, {120, {10.2, 21}, 0}};
  const Flattening flat = Must(Flatten(cap, options));
  CheckSound(cap, flat);
  for (const UvPin& pin : options.pins) EXPECT_EQ(flat.uv[pin.vertex], pin.uv);
  EXPECT_TRUE(flat.charts[0].anchors.empty());
}

// A developable pinned where it would lie anyway stays exact, turned and moved as the pins say.
TEST(FlattenOptionsTest, PinsPlaceADevelopable) {
  const Developable made = Accordion(8, 6, 4, 1, 2.4, 2);
  const Complex turn = std::polar(1.0, 2.1), shift(7, -3);
  for (const double weight : {0.0, 10.0}) {
    FlattenOptions options;
    for (const std::uint32_t v : {0u, 17u, 40u}) {
      options.pins.push_back({v, turn * made.flat[v] + shift, weight});
    }
    const Flattening flat = Must(Flatten(made.surface, options));
    for (std::size_t v = 0; v < made.flat.size(); ++v) {
      EXPECT_LE(std::abs(flat.uv[v] - (turn * made.flat[v] + shift)), 1e-8) << weight;
    }
  }
}

TEST(FlattenOptionsTest, SoftPinsPullTheHarderTheHeavier) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  const Flattening free = Must(Flatten(cap, Refined()));
  double last = 1e300;
  for (const double weight : {0.1, 1.0, 10.0, 1e6}) {
    FlattenOptions options = Refined();
    options.pins = {{3, free.uv[3], weight}, {100, free.uv[100] + Complex(0.5, 0), weight}};
    const Flattening flat = Must(Flatten(cap, options));
    const double miss =
        std::abs(flat.uv[3] - options.pins[0].uv) + std::abs(flat.uv[100] - options.pins[1].uv);
    EXPECT_LT(miss, last) << weight;
    last = miss;
  }
  EXPECT_LE(last, 1e-4);
}

TEST(FlattenOptionsTest, OnePinMovesTheLayout) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.2);
  const Flattening free = Must(Flatten(cap, Refined()));
  FlattenOptions options = Refined();
  options.pins = {{20, {100, 50}, 0}};
  const Flattening flat = Must(Flatten(cap, options));
  EXPECT_EQ(flat.uv[20], Complex(100, 50));
  for (std::size_t v = 0; v < flat.uv.size(); ++v) {
    EXPECT_LE(std::abs(flat.uv[v] - free.uv[v] - (Complex(100, 50) - free.uv[20])), 1e-9);
  }
}

TEST(FlattenOptionsTest, AGrainLineHasItsDirection) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.2);
  for (const double angle : {0.0, 0.5 * std::numbers::pi, -2.5}) {
    FlattenOptions options = Refined();
    options.grain_lines = {{5, 40, angle}};
    const Flattening flat = Must(Flatten(cap, options));
    const Complex along = flat.uv[40] - flat.uv[5];
    EXPECT_LE(std::abs(along / std::abs(along) - std::polar(1.0, angle)), 1e-12);
  }
}

TEST(FlattenOptionsTest, WrongPinsAndGrainLinesAreNamed) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.2);
  const auto fault = [&](std::vector<UvPin> pins, std::vector<GrainLine> lines) {
    FlattenOptions options;
    options.pins = std::move(pins);
    options.grain_lines = std::move(lines);
    const auto flat = Flatten(cap, options);
    EXPECT_FALSE(flat.has_value());
    return flat ? Fault{} : flat.error();
  };
  const double nan = std::nan("");
  EXPECT_EQ(fault({{9999, 0, 0}}, {}).kind, FaultKind::kIndexOutOfRange);
  EXPECT_EQ(fault({{9999, 0, 0}}, {}).field, "pins[0].vertex");
  EXPECT_EQ(fault({{1, 0, 0}, {2, {nan, 0}, 0}}, {}).field, "pins[1]");
  EXPECT_EQ(fault({{1, 0, -1}}, {}).field, "pins[0].weight");
  EXPECT_EQ(fault({{1, 0, 2e9}}, {}).field, "pins[0].weight");
  EXPECT_EQ(fault({{1, 0, 0}, {1, 1, 0}}, {}).field, "pins[1].vertex");
  EXPECT_EQ(fault({{1, 3, 0}, {2, 3, 0}}, {}).kind, FaultKind::kInvalidOption);
  EXPECT_EQ(fault({}, {{1, 1, 0}}).field, "grain_lines[0]");
  EXPECT_EQ(fault({}, {{1, 9999, 0}}).field, "grain_lines[0].to_vertex");
  EXPECT_EQ(fault({}, {{1, 2, nan}}).field, "grain_lines[0]");
  EXPECT_EQ(fault({}, {{1, 2, 0}, {3, 4, 0}}).field, "grain_lines[1]");
  EXPECT_EQ(fault({{1, 0, 0}, {2, 1, 0}}, {{3, 4, 0}}).field, "grain_lines[0]");
}

TEST(FlattenOptionsTest, ComponentsLieSideBySideAtTrueSize) {
  const Developable roll = RolledSheet(20, 8, 10, 4, 1.5, 1),
                    patch = ConePatch(20, 8, 1, 3, 4, 5, 3);
  const SurfaceMesh both = Together(roll.surface, patch.surface, {20, 0, 0});
  const Flattening flat = Must(Flatten(both, Refined()));
  CheckSound(both, flat);
  ASSERT_EQ(flat.charts.size(), 2u);
  EXPECT_FALSE(flat.overlaps);
  EXPECT_NEAR(flat.distortion.area_ratio, 1, 1e-8);
  EXPECT_LE(flat.distortion.max_stretch_percent, 1e-6);
  const std::vector<Complex> first(flat.uv.begin(),
                                   flat.uv.begin() + static_cast<long>(roll.flat.size()));
  EXPECT_LE(RelativeDistanceUpToMotion(first, roll.flat), 1e-8);
}

TEST(FlattenOptionsTest, ClosedSurfacesNeedACut) {
  const SurfaceMesh ball = Sphere(12, 16);
  const auto refused = Flatten(ball, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().kind, FaultKind::kNotADisk);
  FlattenOptions options = Refined();
  options.cut.auto_cut = true;
  const Flattening flat = Must(Flatten(ball, options));
  CheckSound(ball, flat);
  EXPECT_GT(flat.auto_cuts, 0u);
  EXPECT_EQ(flat.charts[0].loops.size(), 1u);
  EXPECT_EQ(CountFlipped(flat.corner_uv, flat.uv), flat.distortion.flipped);
}

TEST(FlattenOptionsTest, LayoutsWithoutFlipsOnRequest) {
  const SurfaceMesh ball = SphereCap(20, 30, 2.8);
  FlattenOptions options;
  options.method = FlattenMethod::kFirstStep;
  options.anchors = FlattenAnchors::kCentreEdge;
  ASSERT_GT(Must(Flatten(ball, options)).distortion.flipped, 0u);  // else there is nothing to show
  options.injective = true;
  const Flattening flat = Must(Flatten(ball, options));
  CheckSound(ball, flat);
  EXPECT_EQ(flat.distortion.flipped, 0u);
  for (const auto& t : flat.corner_uv) EXPECT_GT(SignedArea(t, flat.uv), 0);
}

// Pins that turn a triangle over leave no such layout.
TEST(FlattenOptionsTest, AnImpossibleLayoutIsRefused) {
  const SurfaceMesh cap = SphereCap(6, 12, 1.0);
  const Triangle& t = cap.triangles[30];
  FlattenOptions options;
  options.injective = true;
  options.pins = {{t[0], {0, 0}, 0}, {t[1], {0, 0.1}, 0}, {t[2], {0.1, 0}, 0}};
  const auto flat = Flatten(cap, options);
  ASSERT_FALSE(flat.has_value());
  EXPECT_EQ(flat.error().kind, FaultKind::kNotInjective);
}

// A sheet with an extra vertex on an edge, closed by a triangle without area.
SurfaceMesh SheetWithSliver() {
  SurfaceMesh mesh = Accordion(6, 4, 3, 2, 1.0, 5).surface;
  const Triangle t = mesh.triangles[9];
  const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.push_back(ToPoint3(0.5 * (Vec(mesh.vertices[t[0]]) + Vec(mesh.vertices[t[1]]))));
  mesh.triangles[9] = {t[0], middle, t[2]};
  mesh.triangles.push_back({middle, t[1], t[2]});
  mesh.triangles.push_back({t[0], t[1], middle});
  return mesh;
}

TEST(FlattenOptionsTest, TrianglesWithoutAreaAreLeftOutOnRequest) {
  const SurfaceMesh mesh = SheetWithSliver();
  const auto refused = Flatten(mesh, {});
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().kind, FaultKind::kDegenerateTriangle);
  EXPECT_EQ(refused.error().elements,
            std::vector<std::uint32_t>{static_cast<std::uint32_t>(mesh.triangles.size() - 1)});
  for (const Basis basis : {Basis::kFace, Basis::kEdge}) {
    for (const auto& [weights, method] : {std::pair{Weights::kCotangent, FlattenMethod::kArap},
                                          std::pair{Weights::kUniform, FlattenMethod::kArap},
                                          std::pair{Weights::kCotangent, FlattenMethod::kAbf}}) {
      FlattenOptions options = Refined();
      options.energy = {basis, weights, {}};
      options.cut.tolerate_degenerate = true;
      options.method = method;
      const Flattening flat = Must(Flatten(mesh, options));
      CheckSound(mesh, flat);
      EXPECT_EQ(flat.degenerate.size(), 1u);
      EXPECT_EQ(flat.singular_values.back(), (std::array<double, 2>{0, 0}));
      EXPECT_EQ(flat.distortion.flipped, 0u);
      EXPECT_LE(flat.distortion.max_stretch_percent, 1e-2);
      EXPECT_LE(flat.distortion.max_compression_percent, 1e-2);
    }
  }
}

// One triangle, and a strip without inner vertices: exact, whatever the method.
TEST(FlattenOptionsTest, SmallMeshesAreExact) {
  SurfaceMesh one;
  one.vertices = {{0, 0, 0}, {1, 0, 1}, {0, 2, 1}};
  one.triangles = {{0, 1, 2}};
  SurfaceMesh strip = one;
  strip.vertices.push_back({3, 1, 0});
  strip.vertices.push_back({2, 4, 2});
  strip.triangles.push_back({2, 1, 3});
  strip.triangles.push_back({2, 3, 4});
  for (const SurfaceMesh& mesh : {one, strip}) {
    for (const auto method :
         {FlattenMethod::kArap, FlattenMethod::kFirstStep, FlattenMethod::kAbf}) {
      for (const auto anchors : {FlattenAnchors::kCentreEdge, FlattenAnchors::kSpectral}) {
        FlattenOptions options;
        options.method = method;
        options.anchors = anchors;
        options.injective = true;
        options.refine = 5;
        const Flattening flat = Must(Flatten(mesh, options));
        CheckSound(mesh, flat);
        EXPECT_LE(flat.distortion.arap_energy, 1e-16) << static_cast<int>(method);
      }
    }
  }
}

constexpr std::uint32_t kAround = 24, kAcross = 4;

// A closed band and the seam that opens it.
std::pair<SurfaceMesh, CutOptions> Band() {
  SurfaceMesh band;
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAround;
    for (std::uint32_t j = 0; j <= kAcross; ++j) {
      band.vertices.push_back({std::cos(angle), std::sin(angle), 0.3 * j});
    }
  }
  const auto at = [](std::uint32_t i, std::uint32_t j) {
    return (i % kAround) * (kAcross + 1) + j;
  };
  for (std::uint32_t i = 0; i < kAround; ++i) {
    for (std::uint32_t j = 0; j < kAcross; ++j) {
      band.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      band.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  CutOptions cut;
  for (std::uint32_t j = 0; j < kAcross; ++j) cut.seams.push_back({at(0, j), at(0, j + 1)});
  return {band, cut};
}

// Pins and grain lines on the seam keep to one side of it.
TEST(FlattenOptionsTest, WishesOnASeamKeepToOneSide) {
  auto [band, cut] = Band();
  for (const std::size_t turn : {0u, 50u, 97u}) {
    std::rotate(band.triangles.begin(), band.triangles.begin() + static_cast<long>(turn),
                band.triangles.end());
    FlattenOptions options = Refined();
    options.cut = cut;
    options.grain_lines = {{0, kAcross, 0.3}};
    Flattening flat = Must(Flatten(band, options));
    // The seam is straight and its two copies are parallel: whichever it was, a side has the angle.
    for (const auto& t : flat.corner_uv) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        if (flat.source[a] != 0 || flat.source[b] != 1) continue;
        EXPECT_NEAR(std::arg(flat.uv[b] - flat.uv[a]), 0.3, 1e-9) << turn;
      }
    }
    options.grain_lines.clear();
    options.pins = {{0, {5, 5}, 0}};
    flat = Must(Flatten(band, options));
    EXPECT_EQ(flat.uv[0], Complex(5, 5));
    EXPECT_LE(flat.distortion.max_stretch_percent, 1e-6);
  }
}

// Cut along a seam, the band lies flat; across it the two copies keep their input vertex.
TEST(FlattenOptionsTest, SeamsOpenABand) {
  const auto [band, cut] = Band();
  FlattenOptions options = Refined();
  options.cut = cut;
  const Flattening flat = Must(Flatten(band, options));
  CheckSound(band, flat);
  EXPECT_EQ(flat.uv.size(), band.vertices.size() + kAcross + 1);
  EXPECT_EQ(flat.cuts.size(), kAcross);
  EXPECT_LE(flat.distortion.max_stretch_percent, 1e-6);  // a developable again
}

// The second time nothing is factored, the answer is the same, and other pins start from the same
// charts.
TEST(FlattenOptionsTest, PreparedSurfacesAnswerAlike) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  const auto prepared = Must(Prepare(cap, {}));
  EXPECT_GT(prepared->bytes(), 0u);
  FlattenOptions options = Refined();
  const Flattening alone = Must(Flatten(cap, options));
  const Flattening first = Must(Flatten(*prepared, options));
  const std::size_t bytes = prepared->bytes();
  const Flattening second = Must(Flatten(*prepared, options));
  EXPECT_EQ(prepared->bytes(), bytes);
  EXPECT_EQ(first.uv, alone.uv);
  EXPECT_EQ(second.uv, alone.uv);
  options.pins = {{3, {0, 0}, 0}, {100, {1, 0}, 0}};
  const Flattening pinned = Must(Flatten(*prepared, options));
  EXPECT_EQ(pinned.uv, Must(Flatten(cap, options)).uv);
  EXPECT_EQ(prepared->bytes(), bytes) << "pins need no factor of their own";
  options.pins[1].uv = {1.1, 0.2};  // the same vertices elsewhere: the same factors
  EXPECT_EQ(Must(Flatten(*prepared, options)).uv, Must(Flatten(cap, options)).uv);
  EXPECT_EQ(prepared->bytes(), bytes);
}

// What was asked before leaves no trace, not in the last bit: the order of elimination, which
// rounding follows, is one for all layouts of a basis.
TEST(FlattenOptionsTest, PreparedSurfacesForgetWhatWasAsked) {
  const SurfaceMesh cap = SphereCap(8, 20, 1.2);
  const auto prepared = Must(Prepare(cap, {}));
  std::vector<FlattenOptions> asked;
  for (const auto anchors :
       {FlattenAnchors::kSpectral, FlattenAnchors::kFarBoundary, FlattenAnchors::kCentreEdge}) {
    for (const Basis basis : {Basis::kEdge, Basis::kEdgeAsPublished, Basis::kFace}) {
      for (const Weights weights : {Weights::kUniform, Weights::kCotangent}) {
        for (const auto method :
             {FlattenMethod::kArap, FlattenMethod::kFirstStep, FlattenMethod::kAbf}) {
          FlattenOptions& options = asked.emplace_back(Refined());
          options.method = method;
          options.energy = {basis, weights, {}};
          options.anchors = anchors;
        }
      }
    }
  }
  for (int round = 0; round < 2; ++round) {
    for (const FlattenOptions& options : asked) {
      EXPECT_EQ(Must(Flatten(*prepared, options)).uv, Must(Flatten(cap, options)).uv);
    }
  }
}

TEST(FlattenOptionsTest, ManyChartsKeepTheirFactors) {
  SurfaceMesh many = SphereCap(3, 6, 1.0);
  for (int i = 1; i < 12; ++i) many = Together(many, SphereCap(3, 6, 1.0), {3.0 * i, 0, 0});
  const auto prepared = Must(Prepare(many, {}));
  const Flattening first = Must(Flatten(*prepared, Refined()));
  const std::size_t bytes = prepared->bytes();
  const Flattening second = Must(Flatten(*prepared, Refined()));
  EXPECT_EQ(first.uv, second.uv);
  EXPECT_EQ(prepared->bytes(), bytes);
  EXPECT_EQ(second.times.order, 0);
  EXPECT_EQ(second.times.factor, 0);
  EXPECT_FALSE(first.overlaps);
}

// Far pins would round the layout away; a wound vertex is no layout without flips.
TEST(FlattenOptionsTest, FarPinsAreRefused) {
  const SurfaceMesh both = Together(SphereCap(3, 6, 1.0), SphereCap(3, 6, 1.0), {5, 0, 0});
  FlattenOptions options;
  options.pins = {{1, {1e7, 0}, 0}};
  const auto far = Flatten(both, options);
  ASSERT_FALSE(far.has_value());
  EXPECT_EQ(far.error().field, "pins[0]");
  options.pins = {{1, {1e5, 0}, 0}};
  const Flattening flat = Must(Flatten(both, options));
  EXPECT_EQ(flat.uv[1], Complex(1e5, 0));
  EXPECT_EQ(flat.distortion.flipped, 0u);
  EXPECT_FALSE(flat.overlaps);
}

// Twelve upright triangles round one vertex, which they wind round twice.
TEST(FlattenOptionsTest, AVertexWoundTwiceIsNotInjective) {
  SurfaceMesh cone;
  cone.vertices.push_back({0, 0, 0});
  for (std::uint32_t k = 0; k < 12; ++k) {
    const double angle = 2 * std::numbers::pi * k / 12;
    // Heights to and fro, so that the twelve sides have the length of the arms.
    cone.vertices.push_back({std::cos(angle), std::sin(angle), k % 2 == 0 ? 0.9 : -0.9});
    cone.triangles.push_back({0, k + 1, (k + 1) % 12 + 1});
  }
  FlattenOptions options = Refined();
  options.injective = true;
  const Flattening flat = Must(Flatten(cone, options));
  double around = 0;
  for (const auto& t : flat.corner_uv) {
    EXPECT_GT(SignedArea(t, flat.uv), 0);
    around += std::arg((flat.uv[t[2]] - flat.uv[t[0]]) / (flat.uv[t[1]] - flat.uv[t[0]]));
  }
  EXPECT_NEAR(around, 2 * std::numbers::pi, 1e-9);
}

// The farthest two vertices of a tiny hole are two.
TEST(FlattenOptionsTest, FarBoundaryVerticesAreTwo) {
  SurfaceMesh ball = Sphere(12, 16);
  // A hole far smaller than the rounding of squared distances: a triangle's middle taken out.
  const Triangle t = ball.triangles[100];
  const Eigen::Vector3d a = Vec(ball.vertices[t[0]]), b = Vec(ball.vertices[t[1]]),
                        c = Vec(ball.vertices[t[2]]);
  const Eigen::Vector3d middle = (a + b + c) / 3;
  const auto first = static_cast<std::uint32_t>(ball.vertices.size());
  for (const Eigen::Vector3d& p : {a, b, c}) {
    ball.vertices.push_back(ToPoint3(middle + 1e-5 * (p - middle)));
  }
  ball.triangles[100] = {t[0], t[1], first};
  for (const Triangle& ring : std::vector<Triangle>{{t[1], first + 1, first},
                                                    {t[1], t[2], first + 1},
                                                    {t[2], first + 2, first + 1},
                                                    {t[2], t[0], first + 2},
                                                    {t[0], first, first + 2}}) {
    ball.triangles.push_back(ring);
  }
  FlattenOptions options;
  options.anchors = FlattenAnchors::kFarBoundary;
  const Flattening flat = Must(Flatten(ball, options));
  ASSERT_EQ(flat.charts[0].anchors.size(), 2u);
  EXPECT_NE(flat.charts[0].anchors[0], flat.charts[0].anchors[1]);
  EXPECT_GT(flat.distortion.area_ratio, 0.01);
}

TEST(FlattenOptionsTest, CancellationReachesTheLoops) {
  const SurfaceMesh cap = SphereCap(12, 30, 1.4);
  int asked = 0;
  const CancelToken count([&]() -> Status {
    ++asked;
    return {};
  });
  FlattenOptions options;
  options.refine = 200;
  ASSERT_TRUE(Flatten(cap, options, {}, count).has_value());
  const int total = asked;
  ASSERT_GT(total, 200);
  for (const int when : {1, total / 2, total}) {
    asked = 0;
    const CancelToken stop([&]() -> Status {
      if (++asked < when) return {};
      return Fail(FaultKind::kCancelled, "enough");
    });
    const auto flat = Flatten(cap, options, {}, stop);
    ASSERT_FALSE(flat.has_value());
    EXPECT_EQ(flat.error().kind, FaultKind::kCancelled);
    EXPECT_EQ(asked, when);
  }
}

}  // namespace
}  // namespace arap::testing
