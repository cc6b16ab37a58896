// The generators keep their promises: upright triangles, exact isometries, nothing lost in
// renumbering.
#include "tests/support/meshes.h"

#include <algorithm>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/mesh/space.h"
#include "tests/support/compare.h"
#include "tests/support/poses.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

void ExpectUpright(const PlanarMesh& mesh) {
  for (const Triangle& t : mesh.triangles) EXPECT_GT(SignedArea(t, mesh.vertices), 1e-3);
}

TEST(Meshes, AllTrianglesAreCounterClockwise) {
  ExpectUpright(Grid(3, 2, 6, 2));
  ExpectUpright(Annulus(2, 12, 1, 3));
  ExpectUpright(TwoComponents(3, 3, 5));
  ExpectUpright(Strip(7));
  ExpectUpright(SingleTriangle());
  for (std::uint64_t seed = 0; seed < 20; ++seed) ExpectUpright(JitteredGrid(6, 5, seed, 0.24));
}

TEST(Meshes, CountsAreAsPromised) {
  EXPECT_EQ(Grid(3, 2, 6, 2).vertices.size(), 12U);
  EXPECT_EQ(Grid(3, 2, 6, 2).triangles.size(), 12U);
  EXPECT_EQ(Strip(7).vertices.size(), 9U);
  EXPECT_EQ(Annulus(2, 12, 1, 3).vertices.size(), 36U);
  EXPECT_EQ(TwoComponents(3, 3, 5).triangles.size(), 36U);
}

TEST(Meshes, OneSeedGivesOneMesh) {
  EXPECT_EQ(JitteredGrid(4, 4, 1).vertices, JitteredGrid(4, 4, 1).vertices);
  EXPECT_NE(JitteredGrid(4, 4, 1).vertices, JitteredGrid(4, 4, 2).vertices);
}

TEST(Meshes, RenumberingKeepsEveryTriangle) {
  const PlanarMesh mesh = JitteredGrid(4, 3, 9);
  const RenumberedMesh renumbered = Renumbered(mesh, 10);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle expected = mesh.triangles[t];
    for (std::uint32_t& v : expected) v = renumbered.new_vertex[v];
    const Triangle& actual = renumbered.mesh.triangles[renumbered.new_triangle[t]];
    const auto first = std::find(expected.begin(), expected.end(), actual[0]);
    ASSERT_NE(first, expected.end());
    std::rotate(expected.begin(), first, expected.end());
    EXPECT_EQ(actual, expected);
  }
  ExpectUpright(renumbered.mesh);
}

void ExpectIsometric(const Developable& sheet) {
  ASSERT_EQ(sheet.flat.size(), sheet.surface.vertices.size());
  for (const Triangle& t : sheet.surface.triangles) {
    EXPECT_GT(SignedArea(t, sheet.flat), 1e-4);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k];
      const std::uint32_t b = t[(k + 1) % 3];
      EXPECT_NEAR((Vec(sheet.surface.vertices[b]) - Vec(sheet.surface.vertices[a])).norm(),
                  std::abs(sheet.flat[b] - sheet.flat[a]), 1e-12);
    }
  }
}

TEST(Surfaces, DevelopablesAreIsometricToTheirFlatPositions) {
  ExpectIsometric(RolledSheet(12, 5, 10, 4, 1.5, 1));
  ExpectIsometric(Accordion(10, 4, 10, 4, 2.4, 2));
  ExpectIsometric(ConePatch(12, 4, 1, 4, 4.3, 5.9, 3));
}

TEST(Surfaces, SphereCapFacesOutwards) {
  const SurfaceMesh cap = SphereCap(4, 12, 1.2);
  for (const Triangle& t : cap.triangles) {
    const auto a = Vec(cap.vertices[t[0]]);
    EXPECT_GT((Vec(cap.vertices[t[1]]) - a).cross(Vec(cap.vertices[t[2]]) - a).dot(a), 0);
  }
}

TEST(Poses, InnerHandlesLieInTheirTriangles) {
  const PlanarMesh mesh = JitteredGrid(5, 5, 3);
  for (const TextbookHandle& handle : RandomInnerHandles(mesh, 10, 4)) {
    EXPECT_NEAR(handle.weights[0] + handle.weights[1] + handle.weights[2], 1, 1e-15);
    for (const double weight : handle.weights) EXPECT_GT(weight, 0);
  }
}

TEST(Compare, FindsTheMotionBetweenTwoShapes) {
  const PlanarMesh mesh = JitteredGrid(5, 5, 3);
  const RigidMotion motion{2.5, Complex(30, -7)};
  const std::vector<Complex> moved = Apply(motion, mesh.vertices);
  EXPECT_NEAR(BestMotion(mesh.vertices, moved).angle, 2.5, 1e-12);
  EXPECT_LT(RelativeDistanceUpToMotion(mesh.vertices, moved), 1e-14);
  EXPECT_GT(RelativeDistance(mesh.vertices, moved), 1);
}

}  // namespace
}  // namespace arap::testing
