// Surfaces of several charts, cut, closed or with triangles that have no area.
#include <cmath>
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

}  // namespace
}  // namespace arap::testing
