#include "core/mesh/locate.h"

#include <gtest/gtest.h>

#include "core/base/plane.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

Complex PointOf(const PlanarMesh& mesh, const Located& located) {
  Complex p = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    p += located.barycentric[k] * mesh.vertices[mesh.triangles[located.triangle][k]];
  }
  return p;
}

TEST(PlaneTest, AreasHaveTheSignOfTheTurn) {
  EXPECT_EQ(Cross({2, 0}, {1, 3}), 6);
  EXPECT_EQ(Cross({1, 3}, {2, 0}), -6);
  EXPECT_EQ(Dot({2, 1}, {1, 3}), 5);
  EXPECT_EQ(TwiceArea({1, 1}, {3, 1}, {1, 2}), 2);
  const std::vector<Complex> corners{{1, 1}, {3, 1}, {1, 2}};
  EXPECT_EQ(TwiceArea(Triangle{0, 2, 1}, corners), -2);
}

TEST(PlaneTest, FindsTheLowestTriangleAndTheNearestBoundary) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  const auto inside = Locate(mesh.vertices, mesh.triangles, {1.75, 2.25});
  ASSERT_TRUE(inside.has_value());
  EXPECT_LE(std::abs(PointOf(mesh, *inside) - Complex(1.75, 2.25)), 1e-12);
  EXPECT_FALSE(Locate(mesh.vertices, mesh.triangles, {5, 1}).has_value());
  const Topology topology = BuildTopology(mesh.vertices.size(), mesh.triangles);
  const Located near = NearestOnBoundary(mesh.vertices, mesh.triangles, topology, {5.5, 1.25});
  EXPECT_LE(std::abs(PointOf(mesh, near) - Complex(4, 1.25)), 1e-12);
  EXPECT_NEAR(near.distance, 1.5, 1e-12);
  // A vertex belongs to several triangles: the lowest wins.
  const auto corner = Locate(mesh.vertices, mesh.triangles, mesh.vertices[6]);
  std::uint32_t lowest = kNone;
  for (std::uint32_t t = 0; t < mesh.triangles.size() && lowest == kNone; ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v == 6) lowest = t;
    }
  }
  EXPECT_EQ(corner->triangle, lowest);
}

}  // namespace
}  // namespace arap::testing
