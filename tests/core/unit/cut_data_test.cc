// The real surfaces of ARAP_TEST_DATA, good and bad, cut to charts.
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/unit/cut_check.h"
#include "tests/support/obj.h"

namespace arap::testing {
namespace {

class CutDataTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto data = TestData();
    if (!data) GTEST_SKIP() << "ARAP_TEST_DATA is not set";
    folder_ = data->string() + "/3d/";
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
      {"bowtie_vertex", FaultKind::kNonManifoldVertex, {0}},
      {"closed_hourglass", FaultKind::kNonManifoldVertex, {22}},  // its waist
      {"closed_spot", FaultKind::kNotADisk, {0}},
      {"degenerate_zero_area", FaultKind::kDegenerateTriangle, {129}},
      {"degenerate_zero_edge", FaultKind::kDegenerateTriangle, {1700, 1703}},
      {"duplicate_triangle", FaultKind::kDuplicateTriangle, {100, 3600}},
      {"moebius", FaultKind::kNotOrientable, {333, 144}},
      {"nan_coordinate", FaultKind::kNonFiniteCoordinate, {50}},
      {"nonmanifold_fan3", FaultKind::kNonManifoldEdge, {0, 1, 2}},
      {"nonmanifold_triple_vierbein", FaultKind::kNonManifoldEdge, {0, 2, 55}},
  };
  for (const Bad& bad : all) {
    const Fault fault = FaultOf(Read(std::string("bad/") + bad.name), {});
    EXPECT_EQ(fault.kind, bad.kind) << bad.name << ": " << fault.message;
    EXPECT_EQ(fault.elements, bad.elements) << bad.name;
  }
}

TEST_F(CutDataTest, OptionsHelpTheBadSurfaces) {
  CutOptions options = AutoCut();
  options.split_non_manifold = true;
  options.tolerate_degenerate = true;
  const std::vector<std::pair<const char*, std::size_t>> disks{
      {"bowtie_vertex", 2},
      {"closed_hourglass", 2},
      {"closed_spot", 1},
      {"degenerate_zero_area", 1},
      {"degenerate_zero_edge", 1},
      {"nonmanifold_fan3", 3},
      {"nonmanifold_triple_vierbein", 6},
      {"unreferenced_vertices", 1},
      {"unreferenced_vertices_shuffled", 1}};
  for (const auto& [name, count] : disks) {
    SCOPED_TRACE(name);
    MustCutToDisks(Read(std::string("bad/") + name), count, options);
  }
  EXPECT_EQ(FaultOf(Read("bad/moebius"), options).kind, FaultKind::kNotOrientable);
  EXPECT_EQ(FaultOf(Read("bad/duplicate_triangle"), options).kind, FaultKind::kDuplicateTriangle);
}

TEST_F(CutDataTest, GoodSurfacesAreCharts) {
  std::size_t holed = 0;
  for (const char* name :
       {"annulus_cylinder", "dev_accordion", "dev_cone_patch", "dev_rolled_sheet",
        "garment_skirt_annulus", "garment_skirt_panel_a", "garment_skirt_panel_b",
        "garment_skirt_welded", "garment_tee_back", "garment_tee_sleeve_a", "hemisphere",
        "near_cylinder_skew", "spothead", "two_components_skirt"}) {
    SCOPED_TRACE(name);
    const SurfaceMesh mesh = Read(name);
    const CutSurface whole = MustCut(mesh, {});
    EXPECT_THAT(whole.cuts, ::testing::IsEmpty());
    const std::size_t components = whole.topology.components;
    EXPECT_EQ(components, std::string(name) == "two_components_skirt" ? 2u : 1u);
    holed += whole.topology.boundary_loops > components;
    MustCutToDisks(mesh, components, AutoCut());
  }
  EXPECT_EQ(holed, 3u);
}

}  // namespace
}  // namespace arap::testing
