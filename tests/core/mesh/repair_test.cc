#include "core/mesh/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/defects.h"
#include "core/mesh/space.h"
#include "core/mesh/twins.h"
#include "tests/support/must.h"

namespace arap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// nx × ny squares of two triangles over [x0, x1] × [0, 2], row by row from below; vertices and triangles
// are added to those that are there.
void AddGrid(std::uint32_t nx, std::uint32_t ny, double x0, double x1, SurfaceMesh& mesh) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t j = 0; j <= ny; ++j) {
    for (std::uint32_t i = 0; i <= nx; ++i) {
      mesh.vertices.push_back({x0 + (x1 - x0) * i / nx, 2.0 * j / ny, 0});
    }
  }
  for (std::uint32_t j = 0; j < ny; ++j) {
    for (std::uint32_t i = 0; i < nx; ++i) {
      const std::uint32_t v = base + (nx + 1) * j + i;
      mesh.triangles.push_back({v, v + 1, v + nx + 2});
      mesh.triangles.push_back({v, v + nx + 2, v + nx + 1});
    }
  }
}

// [0, 2]² in two halves that have vertices of their own where they meet.
SurfaceMesh Halves(std::uint32_t ny_left, std::uint32_t ny_right) {
  SurfaceMesh mesh;
  AddGrid(1, ny_left, 0, 1, mesh);
  AddGrid(1, ny_right, 1, 2, mesh);
  return mesh;
}

Repair Mend(SurfaceMesh& mesh, const RepairOptions& options) {
  return testing::Must(RepairTriangles(mesh.vertices, mesh.triangles, options, {}, {}));
}

std::vector<std::string> KindsOf(const std::vector<Warning>& warnings) {
  std::vector<std::string> kinds;
  for (const Warning& warning : warnings) kinds.push_back(warning.kind);
  return kinds;
}

std::size_t BorderOf(const SurfaceMesh& mesh) {
  std::size_t border = 0;
  ForEachEdge(SortedSides(mesh.vertices.size(), mesh.triangles),
              [&](std::span<const Side> edge) { border += edge.size() == 1 ? 1u : 0u; });
  return border;
}

double Area(const SurfaceMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    area += TwiceArea(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]) / 2;
  }
  return area;
}

TEST(Twins, EachIsNearItsFirstAndFirstsAreApart) {
  std::mt19937_64 random(3);
  const auto next = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (const double tolerance : {0.0, 1e-3, 0.02, 0.3}) {
    std::vector<Point3> points;
    for (int i = 0; i < 400; ++i) {
      points.push_back({next() - 0.5, next() * 1e3, next()});
      // Near what is there, at the tolerance more or less, and across the walls of cells.
      if (i % 2 == 0) continue;
      points.push_back(points[random() % points.size()]);
      for (double& x : points.back()) x += tolerance * (next() - 0.5) * 1.5;
    }
    points.push_back({0.0, 1, 1});
    points.push_back({-0.0, 1, 1});
    std::vector<std::uint32_t> ids(points.size());
    std::iota(ids.begin(), ids.end(), 0u);
    const auto twins = FirstTwins(points, ids, tolerance);
    std::vector<std::uint32_t> firsts;
    for (std::uint32_t v = 0; v < points.size(); ++v) {
      std::uint32_t expected = v;
      for (const std::uint32_t first : firsts) {
        if ((Vec(points[first]) - Vec(points[v])).squaredNorm() > tolerance * tolerance) continue;
        expected = first;
        break;
      }
      if (expected == v) firsts.push_back(v);
      ASSERT_EQ(twins[v], expected) << v << " at " << tolerance;
    }
    EXPECT_LT(firsts.size(), points.size());
  }
}

TEST(Repair, WeldsTwinsAlongASeam) {
  SurfaceMesh mesh = Halves(4, 4);
  const SurfaceMesh given = mesh;
  const Repair told = Mend(mesh, {});
  EXPECT_FALSE(told.changed());
  ASSERT_THAT(KindsOf(told.warnings), ElementsAre("twin_vertices"));
  EXPECT_EQ(told.warnings[0].count, 5u);
  EXPECT_THAT(told.warnings[0].elements, ElementsAre(10, 12, 14, 16, 18));
  EXPECT_THAT(told.warnings[0].message, HasSubstr("weld joins it"));
  EXPECT_EQ(mesh, given);

  const Repair repair = Mend(mesh, {.weld = true});
  EXPECT_EQ(mesh.vertices, given.vertices);
  EXPECT_EQ(mesh.triangles.size(), given.triangles.size());
  EXPECT_EQ(BorderOf(mesh), 12u);
  EXPECT_THAT(KindsOf(repair.warnings), ElementsAre("welded_vertices"));
  EXPECT_EQ(repair.VertexOf(10), 1u);
  EXPECT_EQ(repair.VertexOf(11), 11u);
  EXPECT_EQ(repair.given, given.triangles);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    EXPECT_EQ(repair.TriangleOf(t), t);
    EXPECT_EQ(repair.CornersOf(t), mesh.triangles[t]);
    EXPECT_EQ(repair.PartsOf(t).begin, t);
    EXPECT_EQ(repair.PartsOf(t).size(), 1u);
  }
}

TEST(Repair, ASoupBecomesOnePiece) {
  SurfaceMesh grid;
  AddGrid(3, 3, 0, 2, grid);
  SurfaceMesh soup;
  for (const Triangle& t : grid.triangles) {
    const auto v = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : t) soup.vertices.push_back(grid.vertices[corner]);
    soup.triangles.push_back({v, v + 1, v + 2});
  }
  const Repair told = Mend(soup, {});
  ASSERT_THAT(KindsOf(told.warnings), ElementsAre("twin_vertices"));
  EXPECT_EQ(told.warnings[0].count, 54u - 16u);
  Mend(soup, {.weld = true});
  EXPECT_EQ(BorderOf(soup), 12u);
  std::set<std::uint32_t> used;
  for (const Triangle& t : soup.triangles) used.insert(t.begin(), t.end());
  EXPECT_THAT(used, SizeIs(16));
}

TEST(Repair, TheToleranceIsInUnitsOfTheMesh) {
  SurfaceMesh apart = Halves(2, 2);
  for (std::size_t v = 6; v < 12; ++v) apart.vertices[v][0] += 1e-3;
  SurfaceMesh mesh = apart;
  EXPECT_FALSE(Mend(mesh, {.weld = true}).changed());
  EXPECT_FALSE(Mend(mesh, {.weld = true, .tolerance = 0.9e-3}).changed());
  EXPECT_TRUE(Mend(mesh, {.weld = true, .tolerance = 1.1e-3}).changed());
  // Equal places alone.
  mesh = apart;
  mesh.vertices[6] = mesh.vertices[1];
  EXPECT_EQ(Mend(mesh, {.weld = true, .tolerance = 0}).warnings[0].count, 1u);
}

TEST(Repair, OptionsOutOfRangeAreFaults) {
  for (const double tolerance : {-1e-9, kInfinity, std::nan("")}) {
    const auto status = CheckRepair({.weld = true, .tolerance = tolerance});
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().kind, FaultKind::kInvalidOption);
    EXPECT_EQ(status.error().field, "repair.tolerance");
  }
  SurfaceMesh mesh = Halves(2, 2);
  const auto large = RepairTriangles(mesh.vertices, mesh.triangles, {.tolerance = 0.1}, {}, {});
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().field, "repair.tolerance");
  EXPECT_EQ(DetailOf(large.error(), "limit").substr(0, 6), "0.0282");
}

TEST(Repair, TrianglesBelowTheToleranceCollapse) {
  SurfaceMesh mesh = Halves(1, 1);
  // A sliver between two places that are one.
  mesh.vertices.push_back({1, 1e-4, 0});
  mesh.triangles.insert(mesh.triangles.begin() + 1, {1, 8, 3});
  const Repair repair = Mend(mesh, {.weld = true, .tolerance = 1e-3});
  EXPECT_THAT(KindsOf(repair.warnings), ElementsAre("welded_vertices", "collapsed_triangles"));
  EXPECT_THAT(mesh.triangles, SizeIs(4));
  EXPECT_EQ(repair.PartsOf(1).size(), 0u);
  EXPECT_EQ(repair.PartsOf(4).begin, 3u);
}

TEST(Repair, DuplicatesAreDroppedWhicheverWayTheyRun) {
  SurfaceMesh mesh;
  AddGrid(2, 2, 0, 2, mesh);
  const SurfaceMesh sheet = mesh;
  mesh.triangles.push_back({sheet.triangles[3][1], sheet.triangles[3][2], sheet.triangles[3][0]});
  const Repair doubled = Mend(mesh, {.drop_duplicates = true});
  EXPECT_EQ(mesh, sheet);
  ASSERT_THAT(KindsOf(doubled.warnings), ElementsAre("dropped_triangles"));
  EXPECT_THAT(doubled.warnings[0].elements, ElementsAre(8));
  EXPECT_THAT(doubled.warnings[0].message, HasSubstr("doubled"));
  EXPECT_EQ(doubled.PartsOf(8).begin, 3u);
  EXPECT_EQ(doubled.PartsOf(8).size(), 1u);

  // The back of every triangle comes before its front.
  mesh.triangles.clear();
  for (const Triangle& t : sheet.triangles) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back(t);
  }
  const Repair sides = Mend(mesh, {.drop_duplicates = true});
  EXPECT_THAT(mesh.triangles, SizeIs(8));
  EXPECT_THAT(sides.warnings[0].message, HasSubstr("8 of them run the other way: both sides"));
  EXPECT_EQ(sides.TriangleOf(5), 10u);
  EXPECT_EQ(sides.PartsOf(11).begin, 5u);
  // A fault about the mended triangles is one about those given.
  const Fault fault =
      sides.OfGiven(Fault(FaultKind::kDegenerateTriangle,
                          "Triangles 5, 0 and 7 are thin, not triangle 4: 5 in all.")
                        .Field("mesh.triangles")
                        .Element(5));
  EXPECT_THAT(fault.elements, ElementsAre(10));
  EXPECT_EQ(fault.message, "Triangles 10, 0 and 14 are thin, not triangle 8: 5 in all.");
}

TEST(Repair, DoubledSheetsWithTheirOwnVerticesAreNotToldAsTwins) {
  SurfaceMesh mesh;
  AddGrid(2, 2, 0, 2, mesh);
  AddGrid(2, 2, 0, 2, mesh);
  for (std::size_t t = 8; t < 16; ++t) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  const Repair told = Mend(mesh, {});
  ASSERT_THAT(KindsOf(told.warnings), ElementsAre("doubled_triangles"));
  EXPECT_EQ(told.warnings[0].count, 8u);
  EXPECT_THAT(told.warnings[0].message, HasSubstr("both sides of a sheet"));
  EXPECT_THAT(told.warnings[0].message, HasSubstr("weld with drop_duplicates"));
  Mend(mesh, {.weld = true, .drop_duplicates = true});
  EXPECT_THAT(mesh.triangles, SizeIs(8));
  EXPECT_EQ(BorderOf(mesh), 8u);
}

TEST(Repair, StitchesTJunctions) {
  // Six edges meet two, and three meet two: vertices of both sides lie inside edges of the other.
  for (const std::uint32_t right : {6u, 3u, 5u}) {
    SurfaceMesh mesh = Halves(2, right);
    Mend(mesh, {.weld = true});
    const SurfaceMesh given = mesh;
    const Repair told = Mend(mesh, {});
    ASSERT_THAT(KindsOf(told.warnings), ElementsAre("t_junctions")) << right;
    const std::size_t inside = right % 2 == 0 ? right - 2 : right;
    EXPECT_EQ(told.warnings[0].count, inside);
    EXPECT_THAT(told.warnings[0].message, HasSubstr("stitch joins it"));

    const Repair repair = Mend(mesh, {.stitch = true});
    EXPECT_THAT(KindsOf(repair.warnings), ElementsAre("split_triangles"));
    EXPECT_EQ(mesh.triangles.size(), given.triangles.size() + inside);
    EXPECT_EQ(BorderOf(mesh), 2 + 2 + 2 + right);
    EXPECT_NEAR(Area(mesh), 4, 1e-12);
    EXPECT_TRUE(std::is_sorted(repair.triangle.begin(), repair.triangle.end()));
    std::size_t parts = 0;
    for (std::uint32_t t = 0; t < given.triangles.size(); ++t) parts += repair.PartsOf(t).size();
    EXPECT_EQ(parts, mesh.triangles.size());
    EXPECT_THAT(Mend(mesh, {}).warnings, IsEmpty());
  }
}

TEST(Repair, ATriangleIsSplitOnAllItsSides) {
  // A triangle with two vertices inside each side, each of which has a neighbour outside.
  SurfaceMesh mesh{{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}};
  const std::array<Point3, 3> corner{mesh.vertices[0], mesh.vertices[1], mesh.vertices[2]};
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d a = Vec(corner[k]), b = Vec(corner[(k + 1) % 3]);
    const Eigen::Vector3d out = a + b - Vec(corner[(k + 2) % 3]);
    const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(ToPoint3((2 * a + b) / 3));
    mesh.vertices.push_back(ToPoint3((a + 2 * b) / 3));
    mesh.vertices.push_back(ToPoint3(out));
    const auto from = static_cast<std::uint32_t>(k), to = static_cast<std::uint32_t>((k + 1) % 3);
    mesh.triangles.push_back({v, from, v + 2});
    mesh.triangles.push_back({v + 1, v, v + 2});
    mesh.triangles.push_back({to, v + 1, v + 2});
  }
  const double area = Area(mesh);
  const Repair repair = Mend(mesh, {.stitch = true});
  EXPECT_EQ(repair.PartsOf(0).size(), 7u);
  EXPECT_THAT(mesh.triangles, SizeIs(16));
  EXPECT_NEAR(Area(mesh), area, 1e-12);
  EXPECT_EQ(BorderOf(mesh), 6u);
  EXPECT_THAT((repair.split.at({0, 2})), ElementsAre(10, 9));
}

TEST(Repair, ACornerThatOnlyTouchesAnEdgeIsNoTJunction) {
  SurfaceMesh mesh;
  AddGrid(1, 1, 0, 1, mesh);
  mesh.vertices.insert(mesh.vertices.end(), {{1, 1, 0}, {2, 0.5, 0}, {2, 1.5, 0}});
  mesh.triangles.push_back({4, 5, 6});
  EXPECT_THAT(Mend(mesh, {}).warnings, IsEmpty());
  EXPECT_FALSE(Mend(mesh, {.stitch = true}).changed());
}

TEST(Repair, BordersThatLieOnOneAnotherAreNotStitchedForEver) {
  // Each of many thin triangles has its long side on one line, all from other places.
  SurfaceMesh mesh;
  constexpr std::uint32_t kCount = 300;
  for (std::uint32_t i = 0; i < kCount; ++i) {
    const double a = i * 1e-3;
    mesh.vertices.insert(mesh.vertices.end(), {{a, 0, 0}, {a + 1, 0, 0}, {a + 0.5, 0.1 + a, 1}});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const Repair told = Mend(mesh, {});
  ASSERT_THAT(KindsOf(told.warnings), ElementsAre("t_junctions"));
  EXPECT_THAT(told.warnings[0].message, HasSubstr("at least"));
  const auto stitched = RepairTriangles(mesh.vertices, mesh.triangles, {.stitch = true}, {}, {});
  ASSERT_FALSE(stitched);
  EXPECT_EQ(stitched.error().field, "repair.stitch");
}

TEST(Repair, WhatCannotBeMeasuredIsLeftToOthers) {
  SurfaceMesh mesh{{{0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}}, {{0, 1, 2}}};
  const Repair repair = Mend(mesh, {.weld = true, .stitch = true});
  EXPECT_FALSE(repair.changed());
  EXPECT_THAT(repair.warnings, IsEmpty());
}

}  // namespace
}  // namespace arap
