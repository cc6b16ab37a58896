// Surfaces of every kind cut to charts: what comes out is checked from scratch against what went
// in.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/cut/boundary_loops.h"
#include "core/cut/cut_surface.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;
using Pair = std::array<std::uint32_t, 2>;

SurfaceMesh Flat(const PlanarMesh& mesh) {
  SurfaceMesh surface{{}, mesh.triangles};
  for (const Complex& p : mesh.vertices) surface.vertices.emplace_back(p.real(), p.imag(), 0);
  return surface;
}

Pair Sorted(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

std::vector<std::string> Kinds(const std::vector<Warning>& warnings) {
  std::vector<std::string> kinds;
  for (const Warning& w : warnings) kinds.push_back(w.kind);
  return kinds;
}

// Triangles by edge, and by directed edge.
std::map<Pair, std::vector<std::uint32_t>> Edges(const std::vector<Triangle>& triangles) {
  std::map<Pair, std::vector<std::uint32_t>> edges;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges[Sorted(triangles[t][k], triangles[t][(k + 1) % 3])].push_back(t);
    }
  }
  return edges;
}

// Euler characteristic of every component, by its lowest vertex.
std::vector<int> EulerCharacteristics(const CutSurface& cut) {
  std::vector<int> euler(cut.topology.components, 0);
  const auto& component = cut.topology.vertex_component;
  for (const std::uint32_t c : component) {
    if (c != kNone) ++euler[c];
  }
  for (const auto& [edge, triangles] : Edges(cut.mesh.triangles)) --euler[component[edge[0]]];
  for (const Triangle& t : cut.mesh.triangles) ++euler[component[t[0]]];
  return euler;
}

// Everything that holds of every result: it is the input, doubled along `cuts` and nowhere else.
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
  EXPECT_EQ(cut.topology.pieces, cut.topology.components);
  EXPECT_THAT(cut.topology.joints, IsEmpty());
  // Planar: χ = 2 − boundary loops, for every component.
  const std::vector<BoundaryLoop> loops = BoundaryLoops(cut.mesh, cut.topology);
  EXPECT_EQ(loops.size(), cut.topology.boundary_loops);
  std::vector<int> expected(cut.topology.components, 2);
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

CutOptions AutoCut() {
  CutOptions options;
  options.auto_cut = true;
  return options;
}

CutOptions WithSeams(std::vector<Pair> seams) {
  CutOptions options;
  options.seams = std::move(seams);
  return options;
}

// The given number of disks.
CutSurface MustCutToDisks(const SurfaceMesh& input, std::size_t disks,
                          const CutOptions& options = AutoCut()) {
  CutSurface cut = MustCut(input, options);
  EXPECT_EQ(EulerCharacteristics(cut), std::vector<int>(disks, 1));
  return cut;
}

double LengthOf(const SurfaceMesh& mesh, const std::vector<Pair>& edges) {
  double length = 0;
  for (const Pair& e : edges) length += (mesh.vertices[e[1]] - mesh.vertices[e[0]]).norm();
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
  MustCutToDisks(Flat(SingleTriangle()), 1);
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
  const CutSurface cut = MustCutToDisks(ring, 1);
  EXPECT_NEAR(LengthOf(ring, cut.cuts), 2, 1e-9) << "straight across";
  EXPECT_EQ(cut.auto_cuts, cut.cuts.size());
  // The same cut as a seam.
  const CutSurface again = MustCutToDisks(ring, 1, WithSeams(cut.cuts));
  EXPECT_EQ(again.mesh.triangles, cut.mesh.triangles);
  EXPECT_EQ(again.auto_cuts, 0u);
}

TEST(CutTest, ClosedSurfacesAreNamedOrCut) {
  const SurfaceMesh ball = Sphere(12, 24);
  const Fault fault = FaultOf(ball, {});
  EXPECT_EQ(fault.kind, FaultKind::kNotADisk);
  EXPECT_THAT(fault.message, HasSubstr("closed"));
  EXPECT_THAT(fault.message, HasSubstr("auto_cut"));
  EXPECT_THAT(fault.elements, ElementsAre(0));
  const CutSurface cut = MustCutToDisks(ball, 1);
  EXPECT_GE(cut.cuts.size(), 2u);
  const auto fault_torus = FaultOf(Torus(12, 8, 3, 1), {});
  EXPECT_EQ(fault_torus.kind, FaultKind::kNotADisk);
  EXPECT_THAT(fault_torus.message, HasSubstr("genus 1"));
}

TEST(CutTest, TheSmallestClosedSurfaceCanBeCut) {
  const SurfaceMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  EXPECT_EQ(MustCutToDisks(tetrahedron, 1).mesh.vertices.size(), 5u);
  // A single edge opens nothing.
  EXPECT_EQ(FaultOf(tetrahedron, WithSeams({{0, 1}})).kind, FaultKind::kNotADisk);
  MustCutToDisks(tetrahedron, 1, WithSeams({{0, 1}, {1, 2}}));
}

TEST(CutTest, HandlesAreCutShort) {
  const SurfaceMesh torus = Torus(40, 16, 3, 1);
  const CutSurface cut = MustCutToDisks(torus, 1);
  // Once round the tube and once through the hole, which is 2π(3 − 1) long.
  EXPECT_LE(LengthOf(torus, cut.cuts), 1.15 * 2 * std::numbers::pi * (1 + 2));
  for (std::size_t genus = 1; genus <= 4; ++genus) {
    const SurfaceMesh plate = PlateWithHoles(genus, 4);
    EXPECT_THAT(FaultOf(plate, {}).message, HasSubstr("genus " + std::to_string(genus)));
    MustCutToDisks(plate, 1);
  }
  // A torus with three holes has both.
  SurfaceMesh open = torus;
  open.triangles.erase(open.triangles.begin() + 900);
  open.triangles.erase(open.triangles.begin() + 500);
  open.triangles.erase(open.triangles.begin() + 10);
  EXPECT_EQ(FaultOf(open, {}).kind, FaultKind::kNotADisk);
  MustCutToDisks(open, 1);
}

TEST(CutTest, EveryComponentIsCutOnItsOwn) {
  const SurfaceMesh two = Together(Sphere(8, 12), Torus(16, 10, 3, 1), {9, 0, 0});
  const Fault fault = FaultOf(two, {});
  EXPECT_THAT(fault.elements, ElementsAre(0, 168));
  MustCutToDisks(two, 2);
  MustCutToDisks(Together(two, SphereCap(3, 8, 1), {0, 0, 9}), 3);
  MustCutToDisks(Together(Sphere(6, 8), Sphere(6, 8), {3, 0, 0}), 2);
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
  sheet.vertices.emplace_back(-1, 0, 1);
  sheet.vertices.emplace_back(0, -1, 1);
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
  std::map<std::uint32_t, std::uint32_t> merged{{8, 0}};
  for (Triangle& t : ring.triangles) {
    for (auto& v : t) v = v == 8 + 0 ? 4 : v;
  }
  const auto pinched = CutToCharts(ring, split);
  EXPECT_EQ(FaultOf(ring, {}).kind, FaultKind::kNonManifoldVertex);
  EXPECT_THAT(FaultOf(ring, {}).elements, ElementsAre(4));
  ASSERT_TRUE(pinched.has_value());
  CheckAgainst(ring, *pinched);
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
  sheet.vertices.emplace_back(2.5, 2, 1);
  sheet.triangles.push_back({12, 13, 25});
  CutOptions split;
  split.split_non_manifold = true;
  const CutSurface cut = MustCutToDisks(sheet, 2, split);
  EXPECT_EQ(cut.mesh.vertices.size(), 28u);
}

TEST(CutTest, FlatTrianglesAreNamedOrLetThrough) {
  SurfaceMesh sheet = Flat(Grid(2, 2, 2, 2));
  sheet.vertices.emplace_back(0.5, 0, 0);
  sheet.triangles.push_back({1, 0, 9});  // on the lower edge
  const Fault fault = FaultOf(sheet, {});
  EXPECT_EQ(fault.kind, FaultKind::kDegenerateTriangle);
  EXPECT_THAT(fault.elements, ElementsAre(8));
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
  for (auto& p : sheet.vertices) p *= 1e200;
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
  const CutSurface cut = MustCutToDisks(torus, 1);
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
  ball.vertices.emplace_back(7, 7, 7);
  const auto loose = static_cast<std::uint32_t>(ball.vertices.size() - 1);
  const CutSurface cut = MustCutToDisks(ball, 1);
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
  ASSERT_TRUE(CutToCharts(torus, AutoCut(), count(1 << 30)).has_value());
  EXPECT_GT(asked, 8) << "inside the searches too";
  for (int limit = asked - 1; limit >= 0; --limit) {
    const auto result = CutToCharts(torus, AutoCut(), count(limit));
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
      sum += (a.x() * b.y() - b.x() * a.y()) / 2;
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
      tube.vertices.emplace_back(std::cos(a), std::sin(a), end);
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

// Vertices and triangles of an OBJ file; what else is in it is passed over.
SurfaceMesh ReadObj(const std::string& file) {
  SurfaceMesh mesh;
  std::ifstream stream(file);
  EXPECT_TRUE(stream.good()) << file;
  std::string line, word;
  while (std::getline(stream, line)) {
    std::istringstream words(line);
    words >> word;
    std::array<std::string, 3> parts;
    if (word == "v" && words >> parts[0] >> parts[1] >> parts[2]) {
      mesh.vertices.emplace_back(std::strtod(parts[0].c_str(), nullptr),
                                 std::strtod(parts[1].c_str(), nullptr),
                                 std::strtod(parts[2].c_str(), nullptr));
    } else if (word == "f" && words >> parts[0] >> parts[1] >> parts[2]) {
      Triangle t{};
      for (std::size_t k = 0; k < 3; ++k) {
        t[k] = static_cast<std::uint32_t>(std::strtoul(parts[k].c_str(), nullptr, 10) - 1);
      }
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

class CutDataTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("ARAP_TEST_DATA");
    if (data == nullptr) GTEST_SKIP() << "ARAP_TEST_DATA is not set";
    folder_ = std::string(data) + "/3d/";
  }
  SurfaceMesh Read(const std::string& name) const { return ReadObj(folder_ + name + ".obj"); }
  std::string folder_;
};

TEST_F(CutDataTest, BadSurfacesAreNamedWithTheirElements) {
  struct Bad {
    const char* name;
    FaultKind kind;
    std::vector<std::uint32_t> elements;
  };
  const std::vector<Bad> all{
      {"bowtie_vertex", FaultKind::kNonManifoldVertex, {}},
      {"closed_hourglass", FaultKind::kNotADisk, {0}},
      {"closed_spot", FaultKind::kNotADisk, {0}},
      {"degenerate_zero_area", FaultKind::kDegenerateTriangle, {}},
      {"degenerate_zero_edge", FaultKind::kDegenerateTriangle, {}},
      {"duplicate_triangle", FaultKind::kDuplicateTriangle, {100, 3600}},
      {"moebius", FaultKind::kNotOrientable, {}},
      {"nan_coordinate", FaultKind::kNonFiniteCoordinate, {}},
      {"nonmanifold_fan3", FaultKind::kNonManifoldEdge, {0, 1, 2}},
      {"nonmanifold_triple_vierbein", FaultKind::kNonManifoldEdge, {}},
  };
  for (const Bad& bad : all) {
    const Fault fault = FaultOf(Read(std::string("bad/") + bad.name), {});
    EXPECT_EQ(fault.kind, bad.kind) << bad.name << ": " << fault.message;
    std::string ids;
    for (const auto id : fault.elements) ids += std::to_string(id) + " ";
    std::printf("%s: %s [%s]\n", bad.name, fault.message.c_str(), ids.c_str());
    if (!bad.elements.empty()) EXPECT_EQ(fault.elements, bad.elements) << bad.name;
  }
}

}  // namespace
}  // namespace arap::testing
