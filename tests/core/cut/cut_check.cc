#include "tests/core/cut/cut_check.h"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/cut/pieces.h"
#include "core/mesh/space.h"

namespace arap::testing {

using ::testing::IsEmpty;

std::vector<std::string> Kinds(const std::vector<Warning>& warnings) {
  std::vector<std::string> kinds;
  for (const Warning& w : warnings) kinds.push_back(w.kind);
  return kinds;
}

std::map<Pair, std::vector<std::uint32_t>> Edges(const std::vector<Triangle>& triangles) {
  std::map<Pair, std::vector<std::uint32_t>> edges;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges[Sorted(triangles[t][k], triangles[t][(k + 1) % 3])].push_back(t);
    }
  }
  return edges;
}

Topology TopologyOf(const CutSurface& cut) {
  return BuildTopology(cut.mesh.vertices.size(), cut.mesh.triangles);
}

std::vector<int> EulerCharacteristics(const CutSurface& cut) {
  const Topology topology = TopologyOf(cut);
  std::vector<int> euler(topology.components, 0);
  const auto& component = topology.vertex_component;
  for (const std::uint32_t c : component) {
    if (c != kNone) ++euler[c];
  }
  for (const auto& [edge, triangles] : Edges(cut.mesh.triangles)) --euler[component[edge[0]]];
  for (const Triangle& t : cut.mesh.triangles) ++euler[component[t[0]]];
  return euler;
}

void CheckAgainst(const SurfaceMesh& input, const CutSurface& cut) {
  ASSERT_EQ(cut.mesh.triangles.size(), input.triangles.size());
  ASSERT_EQ(cut.turned.size(), input.triangles.size());
  ASSERT_EQ(cut.source.size(), cut.mesh.vertices.size());
  for (std::uint32_t v = 0; v < cut.source.size(); ++v) {
    if (v < input.vertices.size()) {
      EXPECT_EQ(cut.source[v], v);
    }
    EXPECT_EQ(cut.mesh.vertices[v], input.vertices[cut.source[v]]);
  }
  for (std::size_t t = 0; t < input.triangles.size(); ++t) {
    Triangle welded = cut.mesh.triangles[t];
    for (auto& v : welded) v = cut.source[v];
    if (cut.turned[t]) std::swap(welded[1], welded[2]);
    EXPECT_EQ(welded, input.triangles[t]);
  }
  // Manifold and oriented: no directed edge twice, no vertex with two fans.
  std::set<Pair> directed;
  for (const Triangle& t : cut.mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_TRUE(directed.insert(Pair{t[k], t[(k + 1) % 3]}).second);
    }
  }
  const Topology topology = TopologyOf(cut);
  EXPECT_EQ(topology.pieces, topology.components);
  EXPECT_THAT(topology.joints, IsEmpty());
  EXPECT_EQ(cut.charts, topology.pieces);
  EXPECT_EQ(cut.chart_of, topology.triangle_piece);
  const std::vector<Side> sides = SortedSides(cut.mesh.vertices.size(), cut.mesh.triangles);
  EXPECT_TRUE(
      std::equal(sides.begin(), sides.end(), cut.sides.begin(), cut.sides.end(),
                 [](const Side& a, const Side& b) { return a.SameEdge(b) && a.index == b.index; }));
  // Planar: χ = 2 − boundary loops, for every component.
  const std::vector<BoundaryLoop> loops =
      BoundaryLoops(cut.mesh, cut.sides, topology.vertex_component);
  EXPECT_EQ(loops.size(), topology.boundary_loops);
  std::vector<int> expected(topology.components, 2);
  for (const BoundaryLoop& loop : loops) --expected[loop.component];
  EXPECT_EQ(EulerCharacteristics(cut), expected);
  for (const int euler : expected) EXPECT_LE(euler, 1);
  // What came apart is what is listed.
  std::set<Pair> apart;
  const auto edges = Edges(input.triangles);
  for (const auto& [edge, triangles] : edges) {
    if (triangles.size() != 2) continue;
    std::array<Pair, 2> ends{};
    for (std::size_t i = 0; i < 2; ++i) {
      std::vector<std::uint32_t> both;
      for (const std::uint32_t v : cut.mesh.triangles[triangles[i]]) {
        if (cut.source[v] == edge[0] || cut.source[v] == edge[1]) both.push_back(v);
      }
      ends[i] = Sorted(both[0], both[1]);
    }
    if (ends[0] != ends[1]) apart.insert(edge);
  }
  std::set<Pair> listed;
  for (const Pair& edge : cut.cuts) {
    EXPECT_LT(edge[0], edge[1]);
    EXPECT_TRUE(listed.insert(edge).second) << "listed twice";
  }
  std::erase_if(listed, [&](const Pair& edge) { return edges.at(edge).size() > 2; });
  EXPECT_EQ(apart, listed);
  EXPECT_LE(cut.auto_cuts, cut.cuts.size());
}

CutSurface MustCut(const SurfaceMesh& input, const CutOptions& options) {
  auto result = CutToCharts(input, options);
  if (!result) {
    ADD_FAILURE() << FaultName(result.error().kind) << ": " << result.error().message;
    std::abort();
  }
  CheckAgainst(input, *result);
  return *std::move(result);
}

Fault FaultOf(const SurfaceMesh& input, const CutOptions& options) {
  const auto result = CutToCharts(input, options);
  EXPECT_FALSE(result.has_value());
  return result ? Fault{} : result.error();
}

CutSurface MustCutToDisks(const SurfaceMesh& input, std::size_t disks, const CutOptions& options) {
  CutSurface cut = MustCut(input, options);
  EXPECT_EQ(EulerCharacteristics(cut), std::vector<int>(disks, 1));
  return cut;
}

SurfaceMesh Flat(const PlanarMesh& mesh) {
  SurfaceMesh surface{{}, mesh.triangles};
  for (const Complex& p : mesh.vertices) surface.vertices.push_back({p.real(), p.imag(), 0});
  return surface;
}

SurfaceMesh ThreeSheets() {
  return {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}},
          {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
}

double LengthOf(const SurfaceMesh& mesh, const std::vector<Pair>& edges) {
  double length = 0;
  for (const Pair& e : edges)
    length += (Vec(mesh.vertices[e[1]]) - Vec(mesh.vertices[e[0]])).norm();
  return length;
}

CutOptions WithSeams(std::vector<Pair> seams) {
  CutOptions options;
  options.seams = std::move(seams);
  return options;
}

}  // namespace arap::testing
