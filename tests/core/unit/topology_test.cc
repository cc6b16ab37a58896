#include "core/mesh/topology.h"

#include <algorithm>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/gluing.h"
#include "core/mesh/locate.h"
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

TEST(LocateTest, FindsTheLowestTriangleAndTheNearestBoundary) {
  const PlanarMesh mesh = Grid(4, 4, 4, 4);
  const auto inside = Locate(mesh.vertices, mesh.triangles, {1.75, 2.25});
  ASSERT_TRUE(inside.has_value());
  Complex p = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    p += inside->barycentric[k] * mesh.vertices[mesh.triangles[inside->triangle][k]];
  }
  EXPECT_LE(std::abs(p - Complex(1.75, 2.25)), 1e-12);
  EXPECT_FALSE(Locate(mesh.vertices, mesh.triangles, {5, 1}).has_value());
  const Located near = NearestOnBoundary(mesh.vertices, mesh.triangles, Of(mesh), {5.5, 1.25});
  EXPECT_LE(std::abs(near.point - Complex(4, 1.25)), 1e-12);
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
