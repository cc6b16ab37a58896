// Good and bad surfaces cut to charts: some made here, and the real ones of ARAP_TEST_DATA.
#include "tests/support/surfaces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/cut/cut_check.h"
#include "tests/support/meshes.h"
#include "tests/support/obj.h"

namespace arap::testing {
namespace {

struct Bad {
  std::string name;
  SurfaceMesh mesh;
  FaultKind kind;
  std::vector<std::uint32_t> elements;  // empty: two, which are not known beforehand
};

void ExpectNamed(const std::vector<Bad>& all) {
  for (const Bad& bad : all) {
    const Fault fault = FaultOf(bad.mesh, {});
    EXPECT_EQ(fault.kind, bad.kind) << bad.name << ": " << fault.message;
    if (bad.elements.empty()) {
      EXPECT_EQ(fault.elements.size(), 2u) << bad.name;
    } else {
      EXPECT_EQ(fault.elements, bad.elements) << bad.name;
    }
  }
}

struct Mended {
  std::string name;
  SurfaceMesh mesh;
  std::size_t disks;
};

CutOptions EveryHelp() {
  CutOptions options = AutoCut();
  options.split_non_manifold = true;
  options.tolerate_degenerate = true;
  return options;
}

void ExpectMended(const std::vector<Mended>& all) {
  for (const Mended& bad : all) {
    SCOPED_TRACE(bad.name);
    MustCutToDisks(bad.mesh, bad.disks, EveryHelp());
  }
}

struct Good {
  std::string name;
  SurfaceMesh mesh;
  std::size_t components = 1;
};

// Charts as they are, so many of them with holes, which automatic cuts open.
void ExpectCharts(const std::vector<Good>& all, std::size_t holed) {
  std::size_t found = 0;
  for (const Good& good : all) {
    SCOPED_TRACE(good.name);
    const CutSurface whole = MustCut(good.mesh, {});
    EXPECT_THAT(whole.cuts, ::testing::IsEmpty());
    EXPECT_EQ(TopologyOf(whole).components, good.components);
    found += TopologyOf(whole).boundary_loops > good.components;
    MustCutToDisks(good.mesh, good.components, AutoCut());
  }
  EXPECT_EQ(found, holed);
}

// ---- Made here

SurfaceMesh Bowtie() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}};
}

// Two tetrahedra on one tip, vertex 0.
SurfaceMesh Hourglass() {
  SurfaceMesh mesh;
  mesh.vertices = {{0, 0, 0},  {1, 0, 1},  {0, 1, 1},   {-1, -1, 1},
                   {1, 0, -1}, {0, 1, -1}, {-1, -1, -1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2},
                    {0, 5, 4}, {0, 6, 5}, {0, 4, 6}, {4, 5, 6}};
  return mesh;
}

SurfaceMesh Sheet() { return Flat(Grid(4, 4, 4, 4)); }  // edge 12-13 lies inside

SurfaceMesh SheetWithFlatTriangle() {
  SurfaceMesh mesh = Sheet();
  mesh.vertices.push_back({0.5, 0, 0});
  mesh.triangles.push_back({1, 0, 25});  // on the lower edge
  return mesh;
}

// With the ends of an edge on one spot; `flat` becomes the triangles that have both.
SurfaceMesh SheetWithoutAnEdge(std::vector<std::uint32_t>* flat = nullptr) {
  SurfaceMesh mesh = Sheet();
  mesh.vertices[13] = mesh.vertices[12];
  for (std::uint32_t t = 0; t < mesh.triangles.size() && flat != nullptr; ++t) {
    const Triangle& c = mesh.triangles[t];
    if (std::count(c.begin(), c.end(), 12u) + std::count(c.begin(), c.end(), 13u) == 2) {
      flat->push_back(t);
    }
  }
  return mesh;
}

SurfaceMesh SheetWithACopy() {
  SurfaceMesh mesh = Sheet();
  const Triangle& t = mesh.triangles[10];
  mesh.triangles.push_back({t[1], t[2], t[0]});
  return mesh;
}

SurfaceMesh SheetWithLooseVertices() {
  SurfaceMesh mesh = Sheet();
  mesh.vertices.insert(mesh.vertices.begin(), {7, 7, 7});
  mesh.vertices.push_back({8, 8, 8});
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) ++v;
  }
  return mesh;
}

TEST(SurfacesTest, BadSurfacesAreNamedWithTheirElements) {
  std::vector<std::uint32_t> without_edge;
  const SurfaceMesh pinched = SheetWithoutAnEdge(&without_edge);
  ASSERT_EQ(without_edge.size(), 2u);
  SurfaceMesh nan = Sheet();
  nan.vertices[5][1] = std::numeric_limits<double>::quiet_NaN();
  ExpectNamed({
      {"bowtie", Bowtie(), FaultKind::kNonManifoldVertex, {0}},
      {"hourglass", Hourglass(), FaultKind::kNonManifoldVertex, {0}},
      {"closed", Sphere(8, 12), FaultKind::kNotADisk, {0}},
      {"no area", SheetWithFlatTriangle(), FaultKind::kDegenerateTriangle, {32}},
      {"no length", pinched, FaultKind::kDegenerateTriangle, without_edge},
      {"twice", SheetWithACopy(), FaultKind::kDuplicateTriangle, {10, 32}},
      {"moebius", MoebiusBand(12), FaultKind::kNotOrientable, {}},
      {"nan", nan, FaultKind::kNonFiniteCoordinate, {5}},
      {"three sheets", ThreeSheets(), FaultKind::kNonManifoldEdge, {0, 1, 2}},
  });
}

TEST(SurfacesTest, OptionsHelpBadSurfaces) {
  ExpectMended({{"bowtie", Bowtie(), 2},
                {"hourglass", Hourglass(), 2},
                {"closed", Sphere(8, 12), 1},
                {"no area", SheetWithFlatTriangle(), 1},
                {"no length", SheetWithoutAnEdge(), 1},
                {"three sheets", ThreeSheets(), 3},
                {"loose vertices", SheetWithLooseVertices(), 1},
                {"moebius", MoebiusBand(12), 1}});
  EXPECT_EQ(FaultOf(SheetWithACopy(), EveryHelp()).kind, FaultKind::kDuplicateTriangle);
}

TEST(SurfacesTest, GoodSurfacesAreCharts) {
  const SurfaceMesh ring = Flat(Annulus(3, 20, 1, 3));
  ExpectCharts({{"ring", ring},
                {"roll", RolledSheet(20, 8, 10, 4, 1.5, 1).surface},
                {"accordion", Accordion(8, 6, 4, 1, 2.4, 2).surface},
                {"cone", ConePatch(30, 10, 1, 3, 4.4, 5.9, 3).surface},
                {"cap", SphereCap(8, 20, 2.4)},
                {"ring and cap", Together(ring, SphereCap(4, 8, 1.0), {9, 0, 0}), 2}},
               2);
}

// ---- The data

class SurfacesDataTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto data = TestData();
    if (!data) GTEST_SKIP() << "ARAP_TEST_DATA is not set";
    folder_ = data->string() + "/3d/";
  }
  SurfaceMesh Read(const std::string& name) const { return ReadObj(folder_ + name + ".obj"); }
  Bad Named(const std::string& name, FaultKind kind, std::vector<std::uint32_t> elements) const {
    return {name, Read("bad/" + name), kind, std::move(elements)};
  }
  std::string folder_;
};

TEST_F(SurfacesDataTest, BadSurfacesAreNamedWithTheirElements) {
  ExpectNamed({
      Named("bowtie_vertex", FaultKind::kNonManifoldVertex, {0}),
      Named("closed_hourglass", FaultKind::kNonManifoldVertex, {22}),  // its waist
      Named("closed_spot", FaultKind::kNotADisk, {0}),
      Named("degenerate_zero_area", FaultKind::kDegenerateTriangle, {129}),
      Named("degenerate_zero_edge", FaultKind::kDegenerateTriangle, {1700, 1703}),
      Named("duplicate_triangle", FaultKind::kDuplicateTriangle, {100, 3600}),
      Named("moebius", FaultKind::kNotOrientable, {333, 144}),
      Named("nan_coordinate", FaultKind::kNonFiniteCoordinate, {50}),
      Named("nonmanifold_fan3", FaultKind::kNonManifoldEdge, {0, 1, 2}),
      Named("nonmanifold_triple_vierbein", FaultKind::kNonManifoldEdge, {0, 2, 55}),
  });
}

TEST_F(SurfacesDataTest, OptionsHelpBadSurfaces) {
  std::vector<Mended> all;
  for (const auto& [name, disks] :
       std::vector<std::pair<std::string, std::size_t>>{{"bowtie_vertex", 2},
                                                        {"closed_hourglass", 2},
                                                        {"closed_spot", 1},
                                                        {"degenerate_zero_area", 1},
                                                        {"degenerate_zero_edge", 1},
                                                        {"moebius", 1},
                                                        {"nonmanifold_fan3", 3},
                                                        {"nonmanifold_triple_vierbein", 6},
                                                        {"unreferenced_vertices", 1},
                                                        {"unreferenced_vertices_shuffled", 1}}) {
    all.push_back({name, Read("bad/" + name), disks});
  }
  ExpectMended(all);
  EXPECT_EQ(FaultOf(Read("bad/duplicate_triangle"), EveryHelp()).kind,
            FaultKind::kDuplicateTriangle);
}

TEST_F(SurfacesDataTest, GoodSurfacesAreCharts) {
  std::vector<Good> all;
  for (const char* name :
       {"annulus_cylinder", "dev_accordion", "dev_cone_patch", "dev_rolled_sheet",
        "garment_skirt_annulus", "garment_skirt_panel_a", "garment_skirt_panel_b",
        "garment_skirt_welded", "garment_tee_back", "garment_tee_sleeve_a", "hemisphere",
        "near_cylinder_skew", "spothead"}) {
    all.push_back({name, Read(name)});
  }
  all.push_back({"two_components_skirt", Read("two_components_skirt"), 2});
  ExpectCharts(all, 3);
}

}  // namespace
}  // namespace arap::testing
