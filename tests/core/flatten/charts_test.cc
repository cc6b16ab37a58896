// Surfaces of several charts, cut, closed or with triangles that have no area.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/space.h"
#include "tests/core/flatten/fixture.h"
#include "tests/support/compare.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

TEST(ChartsTest, ComponentsLieSideBySideAtTrueSize) {
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

// The corners of the box around all points.
std::pair<Complex, Complex> BoxOf(const std::vector<Complex>& points) {
  Complex low = points[0], high = points[0];
  for (const Complex p : points) {
    low = {std::min(low.real(), p.real()), std::min(low.imag(), p.imag())};
    high = {std::max(high.real(), p.real()), std::max(high.imag(), p.imag())};
  }
  return {low, high};
}

TEST(ChartsTest, AChartThatIsAloneLiesOnItsSmallestRectangle) {
  const Developable roll = RolledSheet(20, 8, 10, 4, 1.5, 1);
  const auto [low, high] = BoxOf(roll.flat);
  for (const Basis basis : {Basis::kFace, Basis::kEdge}) {
    FlattenOptions options = Refined();
    options.energy.basis = basis;
    const Flattening flat = Must(Flatten(roll.surface, options));
    const auto [corner, opposite] = BoxOf(flat.uv);
    EXPECT_LE(std::abs(corner), 1e-9);
    EXPECT_LE(std::abs(opposite - (high - low)), 1e-7);
    EXPECT_LE(RelativeDistanceUpToMotion(flat.uv, roll.flat), 1e-8);
  }
}

TEST(ChartsTest, ClosedSurfacesNeedACut) {
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

// Cut along a seam, the band lies flat; across it the two copies keep their input vertex.
TEST(ChartsTest, SeamsOpenABand) {
  const auto [band, cut] = Band();
  FlattenOptions options = Refined();
  options.cut = cut;
  const Flattening flat = Must(Flatten(band, options));
  CheckSound(band, flat);
  EXPECT_EQ(flat.uv.size(), band.vertices.size() + kAcross + 1);
  EXPECT_EQ(flat.cuts.size(), kAcross);
  EXPECT_LE(flat.distortion.max_stretch_percent, 1e-6);  // a developable again
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

TEST(ChartsTest, TrianglesWithoutAreaAreLeftOutOnRequest) {
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
      if (method == FlattenMethod::kAbf && basis != Basis::kFace) continue;
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
TEST(ChartsTest, SmallMeshesAreExact) {
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

// The farthest two vertices of a tiny hole are two.
TEST(ChartsTest, FarBoundaryVerticesAreTwo) {
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

// A sheet of 6 × 6 cells, one of whose triangles has its tip moved almost onto the longest edge.
SurfaceMesh SheetWithNeedle(double aspect) {
  SurfaceMesh mesh;
  const auto id = [](std::uint32_t i, std::uint32_t j) { return 7 * i + j; };
  for (std::uint32_t i = 0; i <= 6; ++i) {
    for (std::uint32_t j = 0; j <= 6; ++j) {
      mesh.vertices.push_back({i / 6.0, j / 6.0, 0.1 * std::sin(1.0 * i) * std::cos(1.3 * j)});
    }
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    for (std::uint32_t j = 0; j < 6; ++j) {
      mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  const Eigen::Vector3d a = Vec(mesh.vertices[id(2, 2)]), b = Vec(mesh.vertices[id(3, 3)]);
  const Eigen::Vector3d middle = 0.5 * (a + b), tip = Vec(mesh.vertices[id(3, 2)]) - middle;
  mesh.vertices[id(3, 2)] = ToPoint3(middle + (b - a).norm() / aspect * tip.normalized());
  return mesh;
}

const std::vector<std::pair<const char*, FlattenOptions>> kPresets{
    {"ARAP", ArapOptions()},
    {"ARAP, EDGE cells", ArapOptions(Basis::kEdge)},
    {"first step", FirstStepOptions()},
    {"LSCM", LscmOptions()},
    {"ABF", AbfOptions()}};

// Without anchors an aspect of a million is too much.
TEST(ThinTrianglesTest, AreLaidFlat) {
  for (const double aspect : {1e3, 1e4, 1e5, 1e6}) {
    const SurfaceMesh mesh = SheetWithNeedle(aspect);
    for (const auto& [name, options] : kPresets) {
      if (aspect > 1e5 && options.anchors == FlattenAnchors::kSpectral) continue;
      const auto flat = Flatten(mesh, options);
      ASSERT_TRUE(flat) << name << ", " << aspect << ": " << flat.error().message;
      CheckSound(mesh, *flat);
    }
  }
}

TEST(ThinTrianglesTest, AreNamedWhereTheyCannotBeLaidFlat) {
  constexpr std::uint32_t kNeedle = 2 * (6 * 2 + 2);
  for (const double aspect : {1e6, 1e7, 1e8, 5e8}) {
    const SurfaceMesh needle = SheetWithNeedle(aspect);
    const SurfaceMesh alone{{{0, 0, 0}, {1, 0, 0}, {0.3, 1 / aspect, 0}}, {{0, 1, 2}}};
    for (const auto& [name, options] : kPresets) {
      for (const auto& [mesh, thin] : {std::pair(needle, kNeedle), std::pair(alone, 0u)}) {
        const auto flat = Flatten(mesh, options);
        if (flat) {
          CheckSound(mesh, *flat);
          continue;
        }
        EXPECT_EQ(flat.error().kind, FaultKind::kDegenerateTriangle) << name << ", " << aspect;
        EXPECT_EQ(flat.error().field, "mesh.triangles");
        EXPECT_EQ(flat.error().elements, std::vector<std::uint32_t>{thin});
      }
    }
  }
}

}  // namespace
}  // namespace arap::testing
