#include "core/mesh/locate.h"

#include <algorithm>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

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

// Two grids over one another, so that most points lie in two triangles.
TEST(LocateTest, AFinderFindsWhatALookAtEveryTriangleFinds) {
  PlanarMesh mesh = JitteredGrid(12, 9, 7);
  const PlanarMesh over = Moved(mesh, std::polar(0.7, 0.4), {0.1, 0.2});
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), over.vertices.begin(), over.vertices.end());
  for (const Triangle& t : over.triangles) {
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  // The upper one first here and there.
  const auto upper = static_cast<std::ptrdiff_t>(mesh.triangles.size() / 3 * 2);
  std::reverse(mesh.triangles.begin(), mesh.triangles.begin() + upper);

  const auto order = NearbyOrder(mesh.vertices, mesh.triangles);
  TriangleFinder finder(order, mesh.vertices, mesh.triangles);
  std::vector<Complex> points(mesh.vertices);
  for (const Triangle& t : mesh.triangles) {
    const Complex a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    points.insert(points.end(),
                  {(a + b) / 2.0, (a + b + c) / 3.0, a + 1.00002 * (b - a), 2.0 * a - b});
  }
  for (const double tolerance : {kLocateTolerance, 1e-4}) {
    for (const Complex p : points) {
      const auto wanted = Locate(mesh.vertices, mesh.triangles, p, tolerance);
      const auto found = finder.At(p, tolerance);
      ASSERT_EQ(found.has_value(), wanted.has_value()) << p;
      if (!found) continue;
      EXPECT_EQ(found->triangle, wanted->triangle) << p;
      EXPECT_EQ(found->barycentric, wanted->barycentric) << p;
    }
  }
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const auto has = [&](const Triangle& t) { return std::find(t.begin(), t.end(), v) != t.end(); };
    const auto at = std::find_if(mesh.triangles.begin(), mesh.triangles.end(), has);
    EXPECT_EQ(finder.Of(v), static_cast<std::uint32_t>(at - mesh.triangles.begin()));
  }
}

}  // namespace
}  // namespace arap::testing
