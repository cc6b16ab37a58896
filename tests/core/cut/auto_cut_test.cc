// Automatic cuts: every piece becomes a disk, along short paths.
#include <cmath>
#include <numbers>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/space.h"
#include "tests/core/cut/cut_check.h"
#include "tests/support/meshes.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(CutTest, KeepsHolesUnlessAskedToCut) {
  const SurfaceMesh ring = Flat(Annulus(3, 20, 1, 3));
  EXPECT_EQ(TopologyOf(MustCut(ring, {})).boundary_loops, 2u);
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

// n × m cells whose rows are joined at both ends, with a half twist, and whose columns are too when
// `closed`: a Moebius band or a bottle of Klein, in places that mean nothing but are all different.
SurfaceMesh Twisted(std::uint32_t n, std::uint32_t m, bool closed) {
  SurfaceMesh mesh;
  const std::uint32_t rows = closed ? m : m + 1;
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n, r = 10 + (j - 0.5 * m) * std::cos(a / 2);
      const double lift = closed ? std::sin(2 * std::numbers::pi * j / m) : 0;
      mesh.vertices.push_back(
          {r * std::cos(a), r * std::sin(a), (j - 0.5 * m) * std::sin(a / 2) + lift});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    if (i == n) i = 0, j = m - j;
    return (j % rows) * n + i;
  };
  for (std::uint32_t j = 0; j < m; ++j) {
    for (std::uint32_t i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(CutTest, OneSidedSurfacesAreCutOpen) {
  const CutSurface narrow = MustCutToDisks(MoebiusBand(12), 1, AutoCut());
  EXPECT_EQ(narrow.cuts.size(), 1u);
  EXPECT_EQ(narrow.auto_cuts, 1u);
  EXPECT_THAT(Kinds(narrow.warnings), Contains("one_sided"));
  // Straight across, more or less: half-way round from the first triangle.
  const CutSurface wide = MustCutToDisks(Twisted(24, 4, false), 1, AutoCut());
  EXPECT_GE(wide.cuts.size(), 4u);
  EXPECT_LE(wide.cuts.size(), 8u);
  const CutSurface bottle = MustCutToDisks(Twisted(20, 6, true), 1, AutoCut());
  EXPECT_EQ(bottle.auto_cuts, bottle.cuts.size());
  // The same cut as a seam.
  const CutSurface again = MustCutToDisks(Twisted(20, 6, true), 1, WithSeams(bottle.cuts));
  EXPECT_EQ(again.auto_cuts, 0u);
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

TEST(CutTest, CutsThroughFlatTrianglesToo) {
  SurfaceMesh ball = Sphere(10, 16);
  for (std::uint32_t v = 0; v < ball.vertices.size(); v += 7) {
    ball.vertices[v] = ball.vertices[(v + 1) % ball.vertices.size()];
  }
  CutOptions options = AutoCut();
  options.tolerate_degenerate = true;
  EXPECT_FALSE(MustCutToDisks(ball, 1, options).degenerate.empty());
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

}  // namespace
}  // namespace arap::testing
