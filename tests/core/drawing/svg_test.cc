// What the pictures are made of: places, lines, paths, text, colours.
#include "core/drawing/svg.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "core/base/plane.h"

namespace arap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Two triangles on the unit square.
const std::vector<Triangle> kSquare{{0, 1, 2}, {0, 2, 3}};
const std::vector<Complex> kCorners{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

TEST(Svg, ViewFitsTheBoundsAndTurnsYOver) {
  Bounds bounds;
  bounds.Add(std::vector<Complex>{{1, 1}, {3, 2}, {NAN, 7}, {2, INFINITY}});
  EXPECT_EQ(bounds.width(), 2);
  const View view(bounds, 10, 20, 100, 100);
  EXPECT_EQ(view.X(1), 10);
  EXPECT_EQ(view.X(3), 110);
  EXPECT_EQ(view.Y(2), 45);  // centred: 50 high in a box of 100
  EXPECT_EQ(view.Y(1), 95);
}

TEST(Svg, LinesCoverEveryEdgeOnce) {
  EXPECT_THAT(BoundaryLines(kSquare), ElementsAre(ElementsAre(0, 1, 2, 3)));
  EXPECT_THAT(InnerLines(kSquare), ElementsAre(ElementsAre(0, 2)));

  // A fan of six round vertex 0: six inner edges, one boundary.
  std::vector<Triangle> fan;
  for (std::uint32_t k = 0; k < 6; ++k) fan.push_back({0, 1 + k, 1 + (k + 1) % 6});
  EXPECT_EQ(BoundaryLines(fan).size(), 1u);
  std::multiset<std::uint32_t> outer;
  for (const auto& line : InnerLines(fan)) {
    for (std::size_t i = 1; i < line.size(); ++i) outer.insert(std::max(line[i], line[i - 1]));
  }
  EXPECT_THAT(outer, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Svg, PathsAreRelativeAndWithoutDrift) {
  Bounds bounds;
  bounds.Add(kCorners);
  const View view(bounds, 0, 0, 10, 10);
  EXPECT_EQ(PathData({{0, 1, 2, 3}}, /*closed=*/true, kCorners, view), "M0 10l10 0 0-10-10 0z");
}

TEST(Svg, TextIsEscaped) {
  EXPECT_THAT(SvgText(0, 0, 10, "a<b&\""), HasSubstr("a&lt;b&amp;&quot;"));
}

using Values = std::vector<std::array<double, 2>>;  // s1 and s2 of triangles

TEST(Strain, IsTheOneThatIsFartherFromZero) {
  EXPECT_NEAR(PrincipalStrainPercent(1.1, 0.95), 10, 1e-9);
  EXPECT_NEAR(PrincipalStrainPercent(1.01, 0.9), -10, 1e-9);
  // Triangles that were left out have no strain, those that are infinitely long none to draw.
  EXPECT_NEAR(LargestStrainPercent(Values{{1.04, 1}, {0, 0}, {INFINITY, 1}, {1, 0.93}}), 7, 1e-9);
  EXPECT_EQ(LargestStrainPercent({}), 0);
}

TEST(Strain, RangesAreRound) {
  EXPECT_NEAR(StrainRange(4), 5, 1e-12);
  EXPECT_NEAR(StrainRange(0.11), 0.2, 1e-12);
  EXPECT_NEAR(StrainRange(70), 100, 1e-12);
  EXPECT_NEAR(StrainRange(0), 1e-6, 1e-18);
}

TEST(Strain, TrianglesAreGroupedByColour) {
  const auto shades = TrianglesByShade(kSquare, Values{{1.04, 1}, {1, 0.98}}, 4);
  ASSERT_EQ(shades.size(), 2u);
  EXPECT_THAT(shades.at(kStrainShades), ElementsAre(ElementsAre(0, 1, 2)));
  EXPECT_THAT(shades.at(-kStrainShades / 2), ElementsAre(ElementsAre(0, 2, 3)));
  const auto white = TrianglesByShade(kSquare, Values{{1, 1}, {1, 1}}, 1e-6);
  EXPECT_EQ(white.at(0).size(), 2u);
  EXPECT_EQ(StrainColor(0), "#fafafa");
}

}  // namespace
}  // namespace arap
