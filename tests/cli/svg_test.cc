#include <algorithm>
#include <set>
#include <string>

#include <gmock/gmock.h>

#include "core/drawing/svg/animation.h"
#include "core/drawing/svg/document.h"
#include "core/drawing/svg/mesh_lines.h"
#include "core/drawing/svg/strain.h"
#include "core/drawing/svg/view.h"

namespace arap::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Two triangles on the unit square.
const std::vector<std::uint32_t> kSquare{0, 1, 2, 0, 2, 3};
const std::vector<double> kCorners{0, 0, 1, 0, 1, 1, 0, 1};

std::size_t Count(const std::string& text, const std::string& piece) {
  std::size_t count = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos;
       at = text.find(piece, at + piece.size())) {
    ++count;
  }
  return count;
}

Film SquareFilm(std::size_t frames) {
  Film film;
  film.triangles = kSquare;
  film.caption = "a < b & c";
  for (std::size_t i = 0; i < frames; ++i) {
    film.shapes.push_back(kCorners);
    film.handles.push_back({0.5, static_cast<double>(i)});
    film.numbers.push_back(i);
  }
  return film;
}

TEST(Svg, ViewFitsTheBoundsAndTurnsYOver) {
  Bounds bounds;
  bounds.Add(std::vector<double>{1, 1, 3, 2, NAN, 7});
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
  std::vector<std::uint32_t> fan;
  for (std::uint32_t k = 0; k < 6; ++k) fan.insert(fan.end(), {0, 1 + k, 1 + (k + 1) % 6});
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

TEST(Svg, AnimationLoopsOverEveryFrameOfAShortFilm) {
  const std::string svg = FormatAnimation(SquareFilm(30));
  EXPECT_THAT(svg, HasSubstr("viewBox"));
  EXPECT_THAT(svg, HasSubstr("a &lt; b &amp; c"));
  EXPECT_EQ(Count(svg, "attributeName=\"d\" dur=\"1.00s\" repeatCount=\"indefinite\""), 2u);
  EXPECT_EQ(Count(svg, "<circle"), 1u);
  // 2 paths and 2 coordinates of one handle, 29 separators each.
  EXPECT_EQ(Count(svg, ";"), 4 * 29u + 2u);  // and those of the two escapes
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(Svg, AHandleThatComesAndGoesHasNoSizeMeanwhile) {
  Film film = SquareFilm(3);
  film.handles = {{0, 0, NAN, NAN, NAN, NAN}, {0, 0, 1, 1, NAN, NAN}, {0, 0, NAN, NAN, NAN, NAN}};
  const std::string svg = FormatAnimation(film);
  EXPECT_EQ(Count(svg, "<circle"), 2u);  // the third is never there
  EXPECT_EQ(Count(svg, "attributeName=\"r\""), 1u);
  EXPECT_THAT(svg, HasSubstr("values=\"0;11;0\""));
  EXPECT_THAT(svg, HasSubstr("values=\"1040;1040;1040\""));  // it does not jump
  EXPECT_EQ(Count(FormatSheet(film, 8), "<circle"), 4u);
}

TEST(Svg, LongFilmsAreThinnedOut) {
  const std::string svg = FormatAnimation(SquareFilm(1000));
  EXPECT_EQ(Count(svg, ";"), 4 * 83u + 2u);  // every twelfth of 1000 frames
}

TEST(Svg, SheetHasFirstAndLastFrame) {
  EXPECT_THAT(Spread(120, 8), ElementsAre(0, 17, 34, 51, 68, 85, 102, 119));
  EXPECT_THAT(Spread(3, 8), ElementsAre(0, 1, 2));
  EXPECT_THAT(Spread(5, 1), ElementsAre(0));
  EXPECT_THAT(Spread(0, 8), ElementsAre());
  const std::string svg = FormatSheet(SquareFilm(120), 8);
  EXPECT_EQ(Count(svg, "<circle"), 8u);
  EXPECT_THAT(svg, HasSubstr("frame 119"));
  EXPECT_THAT(svg, HasSubstr("frame 0<"));
}

TEST(Strain, IsTheOneThatIsFartherFromZero) {
  EXPECT_NEAR(PrincipalStrainPercent(1.1, 0.95), 10, 1e-9);
  EXPECT_NEAR(PrincipalStrainPercent(1.01, 0.9), -10, 1e-9);
  // Triangles that were left out have no strain, those that are infinitely long none to draw.
  EXPECT_NEAR(LargestStrainPercent(std::vector<double>{1.04, 1, 0, 0, INFINITY, 1, 1, 0.93}), 7,
              1e-9);
  EXPECT_EQ(LargestStrainPercent({}), 0);
}

TEST(Strain, RangesAreRound) {
  EXPECT_NEAR(StrainRange(4), 5, 1e-12);
  EXPECT_NEAR(StrainRange(0.11), 0.2, 1e-12);
  EXPECT_NEAR(StrainRange(70), 100, 1e-12);
  EXPECT_NEAR(StrainRange(0), 1e-6, 1e-18);
}

TEST(Strain, TrianglesAreGroupedByColour) {
  const auto shades = TrianglesByShade(kSquare, std::vector<double>{1.04, 1, 1, 0.98}, 4);
  ASSERT_EQ(shades.size(), 2u);
  EXPECT_THAT(shades.at(kStrainShades), ElementsAre(ElementsAre(0, 1, 2)));
  EXPECT_THAT(shades.at(-kStrainShades / 2), ElementsAre(ElementsAre(0, 2, 3)));
  const auto white = TrianglesByShade(kSquare, std::vector<double>{1, 1, 1, 1}, 1e-6);
  EXPECT_EQ(white.at(0).size(), 2u);
  EXPECT_EQ(StrainColor(0), "#fafafa");
}

}  // namespace
}  // namespace arap::cli
