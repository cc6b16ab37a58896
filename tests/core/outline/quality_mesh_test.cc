#include "core/outline/quality_mesh.h"

#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/plane.h"
#include "core/outline/outline.h"
#include "core/outline/smooth.h"
#include "tests/core/outline/drawn.h"

namespace arap {
namespace {

using testing::AreaOf;
using testing::Box;

Outline Circle(Complex middle, double radius, int points) {
  Outline outline;
  for (int i = 0; i < points; ++i) {
    outline.push_back(middle + std::polar(radius, 2 * std::numbers::pi * i / points));
  }
  return outline;
}

Outline Backwards(Outline outline) {
  std::reverse(outline.begin(), outline.end());
  return outline;
}

// The mesh is as the header says: no angle below `least`, every edge in one direction once, the
// area of the outlines, Euler's formula for its pieces and holes.
void ExpectSound(const QualityMesh& result, double area, std::size_t pieces, std::size_t holes,
                 double least = 20) {
  EXPECT_EQ(result.pieces, pieces);
  EXPECT_EQ(result.holes, holes);
  EXPECT_GE(result.smallest_angle, least);
  const PlanarMesh& mesh = result.mesh;
  std::set<std::pair<std::uint32_t, std::uint32_t>> directed, edges;
  std::set<std::uint32_t> used;
  double sum = 0, smallest = 180;
  for (const Triangle& t : mesh.triangles) {
    sum += TwiceArea(t, mesh.vertices) / 2;
    smallest = std::min(
        smallest, SmallestAngle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      EXPECT_TRUE(directed.emplace(a, b).second);
      edges.emplace(std::min(a, b), std::max(a, b));
      used.insert(a);
    }
  }
  EXPECT_EQ(used.size(), mesh.vertices.size());
  EXPECT_EQ(smallest, result.smallest_angle);
  EXPECT_NEAR(sum, area, 1e-7 * area);
  EXPECT_EQ(mesh.vertices.size() + mesh.triangles.size() + holes, edges.size() + pieces);
}

TEST(MeshOutlines, HasAboutAsManyVerticesAsWereAskedFor) {
  const std::vector<Outline> ring{Circle(0, 10, 60), Backwards(Circle({1, 0}, 4, 24))};
  for (const std::size_t vertices : {300u, 1000u, 5000u}) {
    const auto result = MeshOutlines(ring, vertices);
    ASSERT_TRUE(result) << result.error().message;
    ExpectSound(*result, AreaOf(ring), 1, 1);
    EXPECT_NEAR(static_cast<double>(result->mesh.vertices.size()), static_cast<double>(vertices),
                0.15 * static_cast<double>(vertices));
  }
}

TEST(MeshOutlines, HasWhatTheOutlineNeedsWhenFewerAreAskedFor) {
  const std::vector<Outline> disk{Circle(0, 10, 200)};
  const auto result = MeshOutlines(disk, 3);
  ASSERT_TRUE(result) << result.error().message;
  ExpectSound(*result, AreaOf(disk), 1, 0);
  EXPECT_LT(result->mesh.vertices.size(), 800u);
  // Every point of the outline is a vertex.
  std::size_t found = 0;
  for (const Complex p : disk[0]) {
    for (const Complex q : result->mesh.vertices) found += std::abs(p - q) < 1e-6;
  }
  EXPECT_EQ(found, disk[0].size());
}

TEST(MeshOutlines, PiecesHolesAndPiecesInHoles) {
  std::vector<Outline> outlines{Box(0, 0, 30, 20), Backwards(Box(2, 2, 14, 18)),
                                Backwards(Box(16, 2, 28, 18)), Box(5, 5, 11, 15),
                                Circle({50, 10}, 8, 40)};
  const auto result = MeshOutlines(outlines, 600);
  ASSERT_TRUE(result) << result.error().message;
  ExpectSound(*result, AreaOf(outlines), 3, 2);
  // Which way they run says nothing; and the same input gives the same bytes.
  outlines[1] = Backwards(outlines[1]);
  const auto again = MeshOutlines(outlines, 600);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->mesh, result->mesh);
}

TEST(MeshOutlines, SharpCornersKeepTheirAngleAndNothingElseIsSharp) {
  Outline star;
  for (int i = 0; i < 10; ++i) {
    star.push_back(std::polar(i % 2 == 0 ? 100.0 : 40.0, i * std::numbers::pi / 5));
  }
  const auto result = MeshOutlines(std::vector<Outline>{star}, 800);
  ASSERT_TRUE(result) << result.error().message;
  ExpectSound(*result, AreaOf({star}), 1, 0);

  const std::vector<Outline> needle{{{0, 0}, {100, 0}, {100, 5}}};
  const auto thin = MeshOutlines(needle, 300);
  ASSERT_TRUE(thin) << thin.error().message;
  ExpectSound(*thin, 250, 1, 0, std::atan(0.05) * 180 / std::numbers::pi - 1e-6);
}

TEST(MeshOutlines, TheUnitOfTheOutlinesDoesNotMatter) {
  for (const double unit : {1e-9, 1e9}) {
    const std::vector<Outline> disk{Circle(unit, 10 * unit, 50)};
    const auto result = MeshOutlines(disk, 300);
    ASSERT_TRUE(result) << result.error().message;
    ExpectSound(*result, AreaOf(disk), 1, 0);
  }
}

TEST(MeshOutlines, FarFromZeroItIsTheSameMesh) {
  const std::vector<Outline> near{Box(0, 0, 10, 8), Backwards(Box(2, 3, 5, 6))};
  const auto expected = MeshOutlines(near, 200);
  ASSERT_TRUE(expected) << expected.error().message;
  for (const Complex far : {Complex(1e9, -3e9), Complex(0, 1e12), Complex(-4096, 0)}) {
    SCOPED_TRACE(far);
    std::vector<Outline> moved = near;
    for (Outline& outline : moved) {
      for (Complex& p : outline) p += far;
    }
    const auto result = MeshOutlines(moved, 200);
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->mesh.triangles, expected->mesh.triangles);
    EXPECT_GE(result->smallest_angle, 20);
    for (std::size_t v = 0; v < result->mesh.vertices.size(); ++v) {
      EXPECT_EQ(result->mesh.vertices[v], expected->mesh.vertices[v] + far);
    }
    moved[1] = moved[0];
    EXPECT_EQ(MeshOutlines(moved, 200).error().kind, FaultKind::kInvalidOption);
  }
  // Where no digits are left for triangles.
  const auto lost = MeshOutlines(std::vector<Outline>{Box(1e15 - 1, 0, 1e15, 1)}, 200);
  ASSERT_FALSE(lost);
  EXPECT_EQ(lost.error().kind, FaultKind::kInvalidOption);
  EXPECT_EQ(lost.error().field, "outlines");
}

TEST(MeshOutlines, WhatIsWrongIsRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Outline box = Box(0, 0, 10, 10);
  const struct {
    const char* what;
    std::vector<Outline> outlines;
    std::size_t vertices;
    FaultKind kind;
  } cases[] = {
      {"nothing", {}, 100, FaultKind::kEmptyMesh},
      {"two points", {{{0, 0}, {1, 0}}}, 100, FaultKind::kInvalidOption},
      {"an empty outline", {box, {}}, 100, FaultKind::kInvalidOption},
      {"one place", {{{1, 1}, {1, 1}, {1, 1}}}, 100, FaultKind::kEmptyMesh},
      {"there and back", {{{0, 0}, {1, 0}, {2, 0}}}, 100, FaultKind::kInvalidOption},
      {"a crossing", {{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, 100, FaultKind::kInvalidOption},
      {"two that cross", {box, Box(5, 5, 15, 15)}, 100, FaultKind::kInvalidOption},
      {"one twice", {box, box}, 100, FaultKind::kInvalidOption},
      {"a common side", {box, Box(10, 2, 20, 8)}, 100, FaultKind::kInvalidOption},
      {"a common corner", {box, Box(10, 10, 20, 20)}, 100, FaultKind::kInvalidOption},
      {"a corner on a side", {box, {{10, 5}, {20, 0}, {20, 9}}}, 100, FaultKind::kInvalidOption},
      {"not a number", {{{0, 0}, {1, kNan}, {0, 1}}}, 100, FaultKind::kNonFiniteCoordinate},
      {"infinite", {{{0, 0}, {kInfinity, 0}, {0, 1}}}, 100, FaultKind::kNonFiniteCoordinate},
      {"too far", {{{0, 0}, {1e200, 0}, {0, 1}}}, 100, FaultKind::kNonFiniteCoordinate},
      {"no vertices", {box}, 0, FaultKind::kInvalidOption},
      {"too many vertices", {box}, kMaxAskedVertices + 1, FaultKind::kInvalidOption},
      {"too close", {box, Backwards(Box(1e-8, 1, 9, 9))}, 100, FaultKind::kLimitExceeded},
  };
  for (const auto& [what, outlines, vertices, kind] : cases) {
    const auto result = MeshOutlines(outlines, vertices);
    ASSERT_FALSE(result) << what;
    EXPECT_EQ(result.error().kind, kind) << what << ": " << result.error().message;
  }
  for (const std::size_t most : {10u, 200u}) {
    const auto narrow =
        MeshOutlines(std::vector<Outline>{box, Backwards(Box(1e-3, 1, 9, 9))}, 20, most);
    ASSERT_FALSE(narrow);
    EXPECT_EQ(DetailOf(narrow.error(), "limit"), std::to_string(most));
  }
  const CancelToken cancelled(
      [] { return Status(Fail(FaultKind::kCancelled, "The caller gave up.")); });
  const auto stopped = MeshOutlines(std::vector<Outline>{box}, 1000, kMaxMeshVertices, cancelled);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, FaultKind::kCancelled);
  const auto many = MeshOutlines(
      std::vector<Outline>{Circle(0, 10, static_cast<int>(kMaxOutlinePoints) + 1)}, 100);
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().kind, FaultKind::kLimitExceeded);
}

}  // namespace
}  // namespace arap
