// Surfaces of every kind made into charts: what is refused, split, turned and let through.
#include <algorithm>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/cut/pieces.h"
#include "core/mesh/space.h"
#include "tests/core/cut/cut_check.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(CutTest, LeavesADiskAlone) {
  const SurfaceMesh cap = SphereCap(4, 8, 1.0);
  for (const bool auto_cut : {false, true}) {
    CutOptions options;
    options.auto_cut = auto_cut;
    const CutSurface cut = MustCutToDisks(cap, 1, options);
    EXPECT_EQ(cut.mesh.vertices.size(), cap.vertices.size());
    EXPECT_THAT(cut.cuts, IsEmpty());
    EXPECT_THAT(cut.warnings, IsEmpty());
  }
  MustCutToDisks(Flat(SingleTriangle()), 1, AutoCut());
}

TEST(CutTest, PartsThatTouchInAVertexAreNamedOrSplit) {
  SurfaceMesh sheet = Flat(Grid(2, 2, 2, 2));
  sheet.vertices.push_back({-1, 0, 1});
  sheet.vertices.push_back({0, -1, 1});
  sheet.triangles.push_back({0, 9, 10});
  const Fault fault = FaultOf(sheet, {});
  EXPECT_EQ(fault.kind, FaultKind::kNonManifoldVertex);
  EXPECT_THAT(fault.elements, ElementsAre(0));
  EXPECT_THAT(fault.message, HasSubstr("split_non_manifold"));
  CutOptions split;
  split.split_non_manifold = true;
  const CutSurface cut = MustCutToDisks(sheet, 2, split);
  EXPECT_THAT(Kinds(cut.warnings), ElementsAre("split_vertices"));
  EXPECT_EQ(cut.mesh.triangles.back(), (Triangle{11, 9, 10}));
  // A ring pinched into a point is one part that touches itself.
  SurfaceMesh ring = Flat(Annulus(1, 8, 1, 2));
  for (Triangle& t : ring.triangles) {
    for (auto& v : t) v = v == 8 ? 4 : v;
  }
  EXPECT_EQ(FaultOf(ring, {}).kind, FaultKind::kNonManifoldVertex);
  EXPECT_THAT(FaultOf(ring, {}).elements, ElementsAre(4));
  EXPECT_EQ(TopologyOf(MustCut(ring, split)).boundary_loops, 2u);
}

// Triangles taken out at random, some of them back on other corners: fans counted from scratch.
TEST(TouchingVerticesTest, AreThoseOfSeveralFans) {
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    SurfaceMesh mesh = seed % 2 == 0 ? Flat(JitteredGrid(7, 6, seed)) : Torus(7, 6, 3, 1);
    std::erase_if(mesh.triangles, [&](const Triangle&) { return random.Below(100) < 35; });
    for (Triangle& t : mesh.triangles) {
      if (random.Below(2) == 0) std::swap(t[0], t[1]);
    }
    if (seed % 3 == 0) {  // an edge with a third triangle
      mesh.vertices.push_back({9, 9, 9});
      const Triangle first = mesh.triangles.front();
      const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
      mesh.triangles.push_back({first[0], first[1], last});
      mesh.triangles.push_back({first[1], first[2], last});
    }
    const auto edges = Edges(mesh.triangles);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
      UnionFind fans(mesh.triangles.size());
      for (const auto& [edge, around] : edges) {
        if (edge[0] != v && edge[1] != v) continue;
        for (const std::uint32_t t : around) fans.Join(t, around[0]);
      }
      std::set<std::uint32_t> roots;
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (std::count(mesh.triangles[t].begin(), mesh.triangles[t].end(), v) > 0) {
          roots.insert(fans.Find(t));
        }
      }
      if (roots.size() > 1) expected.push_back(v);
    }
    const auto sides = SortedSides(mesh.vertices.size(), mesh.triangles);
    EXPECT_EQ(TouchingVertices(mesh.vertices.size(), mesh.triangles, sides, GlueAll(sides)),
              expected)
        << seed;
    found += expected.size();
  }
  EXPECT_GT(found, 100u);
}

TEST(CutTest, EdgesOfManyTrianglesAreNamedOrSplit) {
  const Fault fault = FaultOf(ThreeSheets(), {});
  EXPECT_EQ(fault.kind, FaultKind::kNonManifoldEdge);
  EXPECT_THAT(fault.elements, ElementsAre(0, 1, 2));
  EXPECT_THAT(fault.message, HasSubstr("split_non_manifold"));
  CutOptions split;
  split.split_non_manifold = true;
  const CutSurface cut = MustCutToDisks(ThreeSheets(), 3, split);
  EXPECT_THAT(Kinds(cut.warnings), ElementsAre("split_edges"));
  EXPECT_EQ(cut.mesh.vertices.size(), 9u);
  EXPECT_THAT(cut.cuts, IsEmpty());
  // Named as a seam it is cut on purpose.
  const CutSurface seam = MustCutToDisks(ThreeSheets(), 3, WithSeams({{1, 0}}));
  EXPECT_THAT(seam.warnings, IsEmpty());
  EXPECT_THAT(seam.cuts, ElementsAre(Pair{0, 1}));
  EXPECT_EQ(seam.mesh.triangles, cut.mesh.triangles);
}

TEST(CutTest, AFinOnOneEdgeComesOffAndLeavesTheSheetWhole) {
  SurfaceMesh sheet = Flat(Grid(4, 4, 4, 4));  // edge 12-13 lies inside
  sheet.vertices.push_back({2.5, 2, 1});
  sheet.triangles.push_back({12, 13, 25});
  CutOptions split;
  split.split_non_manifold = true;
  const CutSurface cut = MustCutToDisks(sheet, 2, split);
  EXPECT_EQ(cut.mesh.vertices.size(), 28u);
}

TEST(CutTest, FlatTrianglesAreNamedOrLetThrough) {
  SurfaceMesh sheet = Flat(Grid(2, 2, 2, 2));
  sheet.vertices.push_back({0.5, 0, 0});
  sheet.triangles.push_back({1, 0, 9});  // on the lower edge
  const Fault fault = FaultOf(sheet, {});
  EXPECT_EQ(fault.kind, FaultKind::kDegenerateTriangle);
  EXPECT_THAT(fault.elements, ElementsAre(8));
  EXPECT_THAT(fault.message, HasSubstr("tolerate_degenerate"));
  CutOptions tolerant;
  tolerant.tolerate_degenerate = true;
  const CutSurface cut = MustCutToDisks(sheet, 1, tolerant);
  EXPECT_THAT(cut.degenerate, ElementsAre(8));
  EXPECT_THAT(Kinds(cut.warnings), ElementsAre("degenerate_triangles"));
  // Nothing to lay flat at all.
  const SurfaceMesh line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(FaultOf(line, tolerant).kind, FaultKind::kDegenerateTriangle);
  EXPECT_THAT(FaultOf(Together(sheet, line, {9, 9, 9}), tolerant).elements, ElementsAre(9));
  // Too large to be measured.
  for (auto& p : sheet.vertices) p = ToPoint3(1e200 * Vec(p));
  EXPECT_EQ(FaultOf(sheet, tolerant).kind, FaultKind::kDegenerateTriangle);
}

TEST(CutTest, TurnsTrianglesAndSaysWhich) {
  Random random(5);
  SurfaceMesh torus = Torus(12, 8, 3, 1);
  std::vector<bool> expected(torus.triangles.size(), false);
  for (std::uint32_t t = 1; t < torus.triangles.size(); ++t) {
    if (!random.Coin()) continue;
    std::swap(torus.triangles[t][1], torus.triangles[t][2]);
    expected[t] = true;
  }
  const CutSurface cut = MustCutToDisks(torus, 1, AutoCut());
  EXPECT_EQ(cut.turned, expected);
  EXPECT_THAT(Kinds(cut.warnings), ElementsAre("reversed_triangles"));
}

TEST(CutTest, UnreferencedVerticesKeepTheirPlace) {
  SurfaceMesh ball = Sphere(6, 8);
  ball.vertices.push_back({7, 7, 7});
  const auto loose = static_cast<std::uint32_t>(ball.vertices.size() - 1);
  const CutSurface cut = MustCutToDisks(ball, 1, AutoCut());
  EXPECT_EQ(TopologyOf(cut).vertex_component[loose], kNone);
  EXPECT_THAT(Kinds(cut.warnings), ElementsAre("unreferenced_vertices"));
}

}  // namespace
}  // namespace arap::testing
