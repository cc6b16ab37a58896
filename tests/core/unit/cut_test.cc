// Surfaces of every kind cut to charts.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/cut/boundary_loops.h"
#include "core/cut/cut_surface.h"
#include "core/mesh/space.h"
#include "tests/core/unit/cut_check.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

SurfaceMesh Flat(const PlanarMesh& mesh) {
  SurfaceMesh surface{{}, mesh.triangles};
  for (const Complex& p : mesh.vertices) surface.vertices.push_back({p.real(), p.imag(), 0});
  return surface;
}

CutOptions WithSeams(std::vector<Pair> seams) {
  CutOptions options;
  options.seams = std::move(seams);
  return options;
}

double LengthOf(const SurfaceMesh& mesh, const std::vector<Pair>& edges) {
  double length = 0;
  for (const Pair& e : edges)
    length += (Vec(mesh.vertices[e[1]]) - Vec(mesh.vertices[e[0]])).norm();
  return length;
}

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

TEST(CutTest, ASeamInsideADoublesItsInnerVerticesOnly) {
  const SurfaceMesh sheet = Flat(Grid(6, 6, 6, 6));  // vertex 7·row + column
  const CutSurface cut = MustCut(sheet, WithSeams({{16, 17}, {18, 17}, {18, 19}, {16, 17}}));
  EXPECT_EQ(cut.mesh.vertices.size(), sheet.vertices.size() + 2);
  EXPECT_THAT((std::vector(cut.source.begin() + 49, cut.source.end())),
              UnorderedElementsAre(17, 18));
  EXPECT_THAT(cut.cuts, ElementsAre(Pair{16, 17}, Pair{17, 18}, Pair{18, 19}));
  EXPECT_EQ(cut.auto_cuts, 0u);
  EXPECT_EQ(cut.topology.boundary_loops, 2u);  // a slit is a hole
}

TEST(CutTest, ASeamThatEndsOnTheBoundaryDoublesThatEnd) {
  const SurfaceMesh sheet = Flat(Grid(6, 6, 6, 6));
  const CutSurface cut = MustCutToDisks(sheet, 1, WithSeams({{14, 15}, {15, 16}}));
  EXPECT_THAT((std::vector(cut.source.begin() + 49, cut.source.end())),
              UnorderedElementsAre(14, 15));
  // From side to side there are two sheets.
  std::vector<Pair> across;
  for (std::uint32_t i = 0; i < 6; ++i) across.push_back({21 + i, 22 + i});
  MustCutToDisks(sheet, 2, WithSeams(across));
  // Two that cross leave four corners in the middle.
  for (std::uint32_t i = 0; i < 6; ++i) across.push_back({3 + 7 * i, 10 + 7 * i});
  const CutSurface four = MustCutToDisks(sheet, 4, WithSeams(across));
  EXPECT_EQ(std::count(four.source.begin(), four.source.end(), 24u), 4);
}

TEST(CutTest, NamesASeamThatIsNoEdge) {
  const SurfaceMesh sheet = Flat(Grid(3, 3, 3, 3));
  for (const Pair bad : {Pair{5, 15}, Pair{5, 5}, Pair{5, 99}, Pair{0xffffffffu, 0}}) {
    const Fault fault = FaultOf(sheet, WithSeams({{5, 6}, bad}));
    EXPECT_EQ(fault.kind, FaultKind::kUnknownEdge);
    EXPECT_THAT(fault.elements, ElementsAre(bad[0], bad[1]));
    EXPECT_EQ(fault.field, "seams[1]");
  }
}

TEST(CutTest, WarnsOfSeamsThatDoNothing) {
  const SurfaceMesh sheet = Flat(Grid(3, 3, 3, 3));
  const CutSurface cut = MustCutToDisks(sheet, 1, WithSeams({{5, 6}, {0, 1}, {0, 4}}));
  EXPECT_THAT(Kinds(cut.warnings), ElementsAre("boundary_seams", "ineffective_seams"));
  EXPECT_THAT(cut.warnings[0].elements, ElementsAre(1, 2));  // entries
  EXPECT_THAT(cut.warnings[1].elements, ElementsAre(5));
  EXPECT_THAT(cut.cuts, IsEmpty());
  EXPECT_EQ(cut.mesh.vertices.size(), sheet.vertices.size());
}

TEST(CutTest, KeepsHolesUnlessAskedToCut) {
  const SurfaceMesh ring = Flat(Annulus(3, 20, 1, 3));
  EXPECT_EQ(MustCut(ring, {}).topology.boundary_loops, 2u);
  const CutSurface cut = MustCutToDisks(ring, 1, AutoCut());
  EXPECT_NEAR(LengthOf(ring, cut.cuts), 2, 1e-9) << "straight across";
  EXPECT_EQ(cut.auto_cuts, cut.cuts.size());
  // The same cut as a seam.
  const CutSurface again = MustCutToDisks(ring, 1, WithSeams(cut.cuts));
  EXPECT_EQ(again.mesh.triangles, cut.mesh.triangles);
  EXPECT_EQ(again.auto_cuts, 0u);
}

TEST(CutTest, HolesAreJoinedToTheNearest) {
  SurfaceMesh sheet = Flat(Grid(15, 15, 15, 15));
  const auto remove_cell = [&](std::uint32_t column, std::uint32_t row) {
    const std::uint32_t low = 16 * row + column, high = low + 17;
    std::erase_if(sheet.triangles, [&](const Triangle& t) {
      const auto [first, last] = std::minmax({t[0], t[1], t[2]});
      return first == low && last == high;
    });
  };
  remove_cell(6, 7);
  remove_cell(8, 7);
  ASSERT_EQ(sheet.triangles.size(), 2u * 15 * 15 - 4);
  // Either lies 6 from the outside, but only 1 from the other.
  const CutSurface cut = MustCutToDisks(sheet, 1, AutoCut());
  EXPECT_NEAR(LengthOf(sheet, cut.cuts), 6 + 1, 1e-9);
}

TEST(CutTest, ClosedSurfacesAreNamedOrCut) {
  const SurfaceMesh ball = Sphere(12, 24);
  const Fault fault = FaultOf(ball, {});
  EXPECT_EQ(fault.kind, FaultKind::kNotADisk);
  EXPECT_THAT(fault.message, HasSubstr("closed"));
  EXPECT_THAT(fault.message, HasSubstr("auto_cut"));
  EXPECT_THAT(fault.elements, ElementsAre(0));
  const CutSurface cut = MustCutToDisks(ball, 1, AutoCut());
  EXPECT_GE(cut.cuts.size(), 2u);
  const auto fault_torus = FaultOf(Torus(12, 8, 3, 1), {});
  EXPECT_EQ(fault_torus.kind, FaultKind::kNotADisk);
  EXPECT_THAT(fault_torus.message, HasSubstr("genus 1"));
}

TEST(CutTest, TheSmallestClosedSurfaceCanBeCut) {
  const SurfaceMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  MustCutToDisks(tetrahedron, 1, AutoCut());
  // A single edge opens nothing.
  EXPECT_EQ(FaultOf(tetrahedron, WithSeams({{0, 1}})).kind, FaultKind::kNotADisk);
  MustCutToDisks(tetrahedron, 1, WithSeams({{0, 1}, {1, 2}}));
}

TEST(CutTest, ClosedSurfacesAreCutThroughTheirCorners) {
  const SurfaceMesh box = PlateWithHoles(0, 4);
  std::set<std::uint32_t> corners, visited;
  for (std::uint32_t v = 0; v < box.vertices.size(); ++v) {
    const auto p = Vec(box.vertices[v]);
    if ((p.x() == 0 || p.x() == 1) && (p.y() == 0 || p.y() == 3) && (p.z() == 0 || p.z() == 1)) {
      corners.insert(v);
    }
  }
  ASSERT_EQ(corners.size(), 8u);
  const CutSurface cut = MustCutToDisks(box, 1, AutoCut());
  for (const Pair& edge : cut.cuts) {
    for (const std::uint32_t v : edge) {
      if (corners.contains(v)) visited.insert(v);
    }
  }
  EXPECT_EQ(visited, corners);
  EXPECT_NEAR(LengthOf(box, cut.cuts), 6 * 1 + 3, 1e-9) << "the shortest tree over the corners";
}

TEST(CutTest, HandlesAreCutShort) {
  const SurfaceMesh torus = Torus(40, 16, 3, 1);
  const CutSurface cut = MustCutToDisks(torus, 1, AutoCut());
  // Once round the tube and once through the hole, which is 2π(3 − 1) long.
  EXPECT_LE(LengthOf(torus, cut.cuts), 1.15 * 2 * std::numbers::pi * (1 + 2));
  for (std::size_t genus = 1; genus <= 4; ++genus) {
    const SurfaceMesh plate = PlateWithHoles(genus, 4);
    EXPECT_THAT(FaultOf(plate, {}).message, HasSubstr("genus " + std::to_string(genus)));
    MustCutToDisks(plate, 1, AutoCut());
  }
  // A torus with three holes has both.
  SurfaceMesh open = torus;
  open.triangles.erase(open.triangles.begin() + 900);
  open.triangles.erase(open.triangles.begin() + 500);
  open.triangles.erase(open.triangles.begin() + 10);
  EXPECT_EQ(FaultOf(open, {}).kind, FaultKind::kNotADisk);
  MustCutToDisks(open, 1, AutoCut());
}

TEST(CutTest, EveryComponentIsCutOnItsOwn) {
  const SurfaceMesh two = Together(Sphere(8, 12), Torus(16, 10, 3, 1), {9, 0, 0});
  const Fault fault = FaultOf(two, {});
  EXPECT_THAT(fault.elements, ElementsAre(0, 168));
  MustCutToDisks(two, 2, AutoCut());
  MustCutToDisks(Together(two, SphereCap(3, 8, 1), {0, 0, 9}), 3, AutoCut());
  MustCutToDisks(Together(Sphere(6, 8), Sphere(6, 8), {3, 0, 0}), 2, AutoCut());
}

TEST(CutTest, SeamsAndAutomaticCutsTogether) {
  const SurfaceMesh torus = Torus(24, 12, 3, 1);
  std::vector<Pair> ring;  // round the tube
  for (std::uint32_t j = 0; j < 12; ++j) ring.push_back(Sorted(j, (j + 1) % 12));
  const CutSurface tube = MustCut(torus, WithSeams(ring));
  EXPECT_EQ(tube.topology.boundary_loops, 2u);
  CutOptions options = WithSeams(ring);
  options.auto_cut = true;
  const CutSurface cut = MustCutToDisks(torus, 1, options);
  EXPECT_TRUE(std::equal(ring.begin(), ring.end(), cut.cuts.begin()));
  EXPECT_EQ(cut.auto_cuts, cut.cuts.size() - 12);
  // The short way on the inside of the ring costs 24 edges.
  EXPECT_LE(cut.auto_cuts, 24u);
}

TEST(CutTest, AMoebiusBandIsOpenedByASeamOnly) {
  const SurfaceMesh band = MoebiusBand(12);
  EXPECT_EQ(FaultOf(band, {}).kind, FaultKind::kNotOrientable);
  EXPECT_EQ(FaultOf(band, AutoCut()).kind, FaultKind::kNotOrientable);
  const CutSurface cut = MustCutToDisks(band, 1, WithSeams({{6, 7}}));
  EXPECT_EQ(cut.mesh.vertices.size(), band.vertices.size() + 2);
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
  EXPECT_EQ(MustCut(ring, split).topology.boundary_loops, 2u);
}

// Three sheets on one edge 0-1.
SurfaceMesh Fan() {
  return {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, -1, 0}},
          {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
}

TEST(CutTest, EdgesOfManyTrianglesAreNamedOrSplit) {
  const Fault fault = FaultOf(Fan(), {});
  EXPECT_EQ(fault.kind, FaultKind::kNonManifoldEdge);
  EXPECT_THAT(fault.elements, ElementsAre(0, 1, 2));
  EXPECT_THAT(fault.message, HasSubstr("split_non_manifold"));
  CutOptions split;
  split.split_non_manifold = true;
  const CutSurface cut = MustCutToDisks(Fan(), 3, split);
  EXPECT_THAT(Kinds(cut.warnings), ElementsAre("split_edges"));
  EXPECT_EQ(cut.mesh.vertices.size(), 9u);
  EXPECT_THAT(cut.cuts, IsEmpty());
  // Named as a seam it is cut on purpose.
  const CutSurface seam = MustCutToDisks(Fan(), 3, WithSeams({{1, 0}}));
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

TEST(CutTest, CutsThroughFlatTrianglesToo) {
  SurfaceMesh ball = Sphere(10, 16);
  for (std::uint32_t v = 0; v < ball.vertices.size(); v += 7) {
    ball.vertices[v] = ball.vertices[(v + 1) % ball.vertices.size()];
  }
  CutOptions options = AutoCut();
  options.tolerate_degenerate = true;
  EXPECT_FALSE(MustCutToDisks(ball, 1, options).degenerate.empty());
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

TEST(CutTest, PartsOfOneSurfaceAgreeAcrossTheirSeam) {
  SurfaceMesh sheet = Flat(Grid(4, 2, 4, 2));
  std::vector<Pair> seam{{2, 7}, {7, 12}};
  for (std::size_t t = 0; t < sheet.triangles.size(); ++t) {
    if (t % 8 >= 4) std::swap(sheet.triangles[t][1], sheet.triangles[t][2]);
  }
  const CutSurface cut = MustCutToDisks(sheet, 2, WithSeams(seam));
  for (std::size_t t = 0; t < sheet.triangles.size(); ++t) EXPECT_EQ(cut.turned[t], t % 8 >= 4);
}

TEST(CutTest, UnreferencedVerticesKeepTheirPlace) {
  SurfaceMesh ball = Sphere(6, 8);
  ball.vertices.push_back({7, 7, 7});
  const auto loose = static_cast<std::uint32_t>(ball.vertices.size() - 1);
  const CutSurface cut = MustCutToDisks(ball, 1, AutoCut());
  EXPECT_EQ(cut.topology.vertex_component[loose], kNone);
  EXPECT_THAT(Kinds(cut.warnings), ElementsAre("unreferenced_vertices"));
}

TEST(CutTest, RandomSeamsOnRandomSurfaces) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const SurfaceMesh surface = seed % 4 == 0   ? Flat(JitteredGrid(5, 6, seed))
                                : seed % 4 == 1 ? Torus(8, 7, 3, 1)
                                : seed % 4 == 2 ? PlateWithHoles(2, 2)
                                                : MoebiusBand(9);
    CutOptions options = AutoCut();
    const auto edges = Edges(surface.triangles);
    for (const auto& [edge, triangles] : edges) {
      if (random.Below(10) < 1 + seed / 8) options.seams.push_back(edge);
    }
    const auto result = CutToCharts(surface, options);
    if (!result) {
      EXPECT_EQ(result.error().kind, FaultKind::kNotOrientable) << seed;
      EXPECT_EQ(seed % 4, 3u);
      continue;
    }
    CheckAgainst(surface, *result);
    for (const int euler : EulerCharacteristics(*result)) EXPECT_EQ(euler, 1) << seed;
    // The same bytes again; and the cuts as seams leave nothing to do.
    EXPECT_EQ(MustCut(surface, options).mesh.triangles, result->mesh.triangles);
    options.seams = result->cuts;
    const CutSurface again = MustCut(surface, options);
    EXPECT_EQ(again.auto_cuts, 0u);
    EXPECT_EQ(again.mesh.triangles, result->mesh.triangles);
  }
}

TEST(CutTest, EveryCancellationIsHeard) {
  const SurfaceMesh torus = Torus(300, 100, 3, 1);
  int asked = 0;
  const auto count = [&](int limit) {
    asked = 0;
    return CancelToken([&asked, limit]() -> Status {
      if (++asked <= limit) return {};
      return Fail(FaultKind::kCancelled, "enough");
    });
  };
  ASSERT_TRUE(CutToCharts(torus, AutoCut(), {}, count(1 << 30)).has_value());
  EXPECT_GT(asked, 8) << "inside the searches too";
  for (int limit = asked - 1; limit >= 0; --limit) {
    const auto result = CutToCharts(torus, AutoCut(), {}, count(limit));
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().kind, FaultKind::kCancelled);
  }
}

TEST(BoundaryLoopsTest, TheOutlineComesFirstAndRunsWithTheTriangles) {
  const SurfaceMesh rings = Together(Flat(Annulus(2, 12, 1, 3)), Flat(Grid(2, 1, 2, 1)), {9, 0, 0});
  const CutSurface cut = MustCut(rings, {});
  const std::vector<BoundaryLoop> loops = BoundaryLoops(cut.mesh, cut.topology);
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
  const auto loops = BoundaryLoops(tube, BuildTopology(14, tube.triangles));
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_THAT(loops[0].vertices, ElementsAre(0, 1, 2, 3, 4, 5, 6));
  EXPECT_EQ(loops[1].vertices.front(), 7u);
  EXPECT_EQ(loops[1].vertices[1], 13u) << "the other way round";
}

}  // namespace
}  // namespace arap::testing
