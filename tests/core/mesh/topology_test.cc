#include "core/mesh/topology.h"

#include <algorithm>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/gluing.h"
#include "tests/support/meshes.h"

namespace arap::testing {
namespace {

Topology Of(const PlanarMesh& mesh) { return BuildTopology(mesh.vertices.size(), mesh.triangles); }

TEST(TopologyTest, CountsAGrid) {
  const Topology topology = Of(Grid(4, 3, 1, 1));
  EXPECT_EQ(topology.edges.size(), 4u * 4 + 5u * 3 + 4u * 3);
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.pieces, 1u);
  EXPECT_EQ(topology.boundary_loops, 1u);
  EXPECT_TRUE(topology.joints.empty());
}

TEST(TopologyTest, KnowsTrianglesAndOppositesOfAnEdge) {
  const PlanarMesh mesh{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const Topology topology = Of(mesh);
  for (const Edge& e : topology.edges) {
    if (e.v0 == 0 && e.v1 == 2) {
      EXPECT_EQ(e.opposite[0], 1u);
      EXPECT_EQ(e.opposite[1], 3u);
    } else {
      EXPECT_TRUE(e.boundary());
      EXPECT_EQ(e.opposite[1], kNone);
    }
  }
}

TEST(TopologyTest, CountsLoopsComponentsAndUnreferenced) {
  EXPECT_EQ(Of(Annulus(2, 8, 1, 2)).boundary_loops, 2u);
  PlanarMesh two = TwoComponents(3, 3, 1);
  two.vertices.push_back({50, 50});
  const Topology topology = Of(two);
  EXPECT_EQ(topology.components, 2u);
  EXPECT_EQ(topology.boundary_loops, 2u);
  EXPECT_EQ(topology.unreferenced, 1u);
  EXPECT_EQ(topology.vertex_component.back(), kNone);
  EXPECT_EQ(topology.vertex_component.front(), 0u);
}

TEST(TopologyTest, FindsTheJointOfABowtie) {
  const PlanarMesh bowtie{{{0, 0}, {-1, -1}, {-1, 1}, {1, -1}, {1, 1}}, {{0, 2, 1}, {0, 3, 4}}};
  const Topology topology = Of(bowtie);
  EXPECT_EQ(topology.components, 1u);
  EXPECT_EQ(topology.pieces, 2u);
  EXPECT_THAT(topology.joints, ::testing::ElementsAre(0));
  EXPECT_EQ(topology.boundary_loops, 2u);
}

TEST(SidesTest, ComeEdgeByEdge) {
  const PlanarMesh mesh = JitteredGrid(5, 4, 3);
  const std::vector<Side> sides = SortedSides(mesh.vertices.size(), mesh.triangles);
  ASSERT_EQ(sides.size(), 3 * mesh.triangles.size());
  std::vector<bool> seen(sides.size(), false);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const std::uint32_t start = SideStart(mesh.triangles, sides[i].index);
    const std::uint32_t end = SideEnd(mesh.triangles, sides[i].index);
    EXPECT_EQ(sides[i].v0, std::min(start, end));
    EXPECT_EQ(sides[i].v1, std::max(start, end));
    EXPECT_FALSE(seen[sides[i].index]);
    seen[sides[i].index] = true;
    if (i == 0) continue;
    const Side &a = sides[i - 1], &b = sides[i];
    EXPECT_LT(std::tie(a.v0, a.v1, a.index), std::tie(b.v0, b.v1, b.index));
  }
}

TEST(GluingTest, TurnedTrianglesKeepTheirNeighbours) {
  PlanarMesh mesh = Grid(3, 3, 1, 1);
  const auto upright = mesh.triangles;
  for (std::size_t t = 1; t < mesh.triangles.size(); t += 2) {
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  Gluing gluing = GlueAll(SortedSides(mesh.vertices.size(), mesh.triangles));
  const auto turned = TrianglesToTurn(mesh.triangles, gluing);
  ASSERT_TRUE(turned.has_value());
  TurnTriangles(*turned, mesh.triangles, gluing);
  EXPECT_EQ(mesh.triangles, upright);
  EXPECT_EQ(gluing.mate, GlueAll(SortedSides(mesh.vertices.size(), upright)).mate);
  // Once round the outside.
  std::uint32_t side = 0;
  while (!gluing.open(side)) ++side;
  const std::uint32_t first = side;
  int length = 0;
  do {
    EXPECT_EQ(SideEnd(upright, side), SideStart(upright, gluing.NextOpen(side)));
    side = gluing.NextOpen(side);
    ++length;
  } while (side != first);
  EXPECT_EQ(length, 12);
}

}  // namespace
}  // namespace arap::testing
