// Seams: what is cut where the caller says so.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/cut/cut_check.h"
#include "tests/support/meshes.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace arap::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

TEST(CutTest, ASeamInsideADoublesItsInnerVerticesOnly) {
  const SurfaceMesh sheet = Flat(Grid(6, 6, 6, 6));  // vertex 7·row + column
  const CutSurface cut = MustCut(sheet, WithSeams({{16, 17}, {18, 17}, {18, 19}, {16, 17}}));
  EXPECT_EQ(cut.mesh.vertices.size(), sheet.vertices.size() + 2);
  EXPECT_THAT((std::vector(cut.source.begin() + 49, cut.source.end())),
              UnorderedElementsAre(17, 18));
  EXPECT_THAT(cut.cuts, ElementsAre(Pair{16, 17}, Pair{17, 18}, Pair{18, 19}));
  EXPECT_EQ(cut.auto_cuts, 0u);
  EXPECT_EQ(TopologyOf(cut).boundary_loops, 2u);  // a slit is a hole
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

TEST(CutTest, AMoebiusBandIsOpenedByASeam) {
  const SurfaceMesh band = MoebiusBand(12);
  const Fault fault = FaultOf(band, {});
  EXPECT_EQ(fault.kind, FaultKind::kNotOrientable);
  EXPECT_THAT(fault.message, HasSubstr("one side only; give seams or set auto_cut"));
  const CutSurface cut = MustCutToDisks(band, 1, WithSeams({{6, 7}}));
  EXPECT_EQ(cut.mesh.vertices.size(), band.vertices.size() + 2);
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

TEST(CutTest, SeamsAndAutomaticCutsTogether) {
  const SurfaceMesh torus = Torus(24, 12, 3, 1);
  std::vector<Pair> ring;  // round the tube
  for (std::uint32_t j = 0; j < 12; ++j) ring.push_back(Sorted(j, (j + 1) % 12));
  const CutSurface tube = MustCut(torus, WithSeams(ring));
  EXPECT_EQ(TopologyOf(tube).boundary_loops, 2u);
  CutOptions options = WithSeams(ring);
  options.auto_cut = true;
  const CutSurface cut = MustCutToDisks(torus, 1, options);
  EXPECT_TRUE(std::equal(ring.begin(), ring.end(), cut.cuts.begin()));
  EXPECT_EQ(cut.auto_cuts, cut.cuts.size() - 12);
  // The short way on the inside of the ring costs 24 edges.
  EXPECT_LE(cut.auto_cuts, 24u);
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
    ASSERT_TRUE(result) << seed << ": " << result.error().message;
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

}  // namespace
}  // namespace arap::testing
