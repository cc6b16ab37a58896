// Boundary loops in order.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/cut/pieces.h"
#include "tests/core/cut/cut_check.h"
#include "tests/support/meshes.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

using ::testing::ElementsAre;

TEST(BoundaryLoopsTest, TheOutlineComesFirstAndRunsWithTheTriangles) {
  const SurfaceMesh rings = Together(Flat(Annulus(2, 12, 1, 3)), Flat(Grid(2, 1, 2, 1)), {9, 0, 0});
  const CutSurface cut = MustCut(rings, {});
  const std::vector<BoundaryLoop> loops =
      BoundaryLoops(cut.mesh, cut.sides, TopologyOf(cut).vertex_component);
  ASSERT_EQ(loops.size(), 3u);
  const auto area = [&](const BoundaryLoop& loop) {
    double sum = 0;
    for (std::size_t i = 0; i < loop.vertices.size(); ++i) {
      const auto& a = cut.mesh.vertices[loop.vertices[i]];
      const auto& b = cut.mesh.vertices[loop.vertices[(i + 1) % loop.vertices.size()]];
      sum += (a[0] * b[1] - b[0] * a[1]) / 2;
    }
    return sum;
  };
  const double twelfth = std::sin(std::numbers::pi / 6) / 2;
  EXPECT_NEAR(area(loops[0]), 12 * 9 * twelfth, 1e-9);
  EXPECT_NEAR(area(loops[1]), -12 * 1 * twelfth, 1e-9);
  EXPECT_NEAR(loops[0].length, 12 * 6 * std::sin(std::numbers::pi / 12), 1e-9);
  EXPECT_EQ(loops[2].component, 1u);
  EXPECT_NEAR(loops[2].length, 6, 1e-12);
  EXPECT_EQ(loops[2].vertices.size(), 6u);
  for (const BoundaryLoop& loop : loops) {
    EXPECT_EQ(loop.vertices.front(), *std::min_element(loop.vertices.begin(), loop.vertices.end()));
  }
}

TEST(BoundaryLoopsTest, OfEquallyLongOnesTheLowestVertexLeads) {
  SurfaceMesh tube;  // two rings of one length, up to rounding
  for (int end = 0; end < 2; ++end) {
    for (int i = 0; i < 7; ++i) {
      const double a = 2 * std::numbers::pi * (i + 0.3 * end) / 7;
      tube.vertices.push_back({std::cos(a), std::sin(a), static_cast<double>(end)});
    }
  }
  for (std::uint32_t i = 0; i < 7; ++i) {
    const std::uint32_t j = (i + 1) % 7;
    tube.triangles.push_back({i, j, 7 + j});
    tube.triangles.push_back({i, 7 + j, 7 + i});
  }
  const auto loops = BoundaryLoops(tube, SortedSides(14, tube.triangles));
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_THAT(loops[0].vertices, ElementsAre(0, 1, 2, 3, 4, 5, 6));
  EXPECT_EQ(loops[1].vertices.front(), 7u);
  EXPECT_EQ(loops[1].vertices[1], 13u) << "the other way round";
}

}  // namespace
}  // namespace arap::testing
