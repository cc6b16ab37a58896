// Layouts of one surface side by side.
#include "core/drawing/comparison.h"

#include <cmath>

#include <gmock/gmock.h>

namespace arap {
namespace {

using testing::HasSubstr;
using testing::Not;

// The square 2 × 2 in the plane x = 3, seen along x with y up: z goes to the left.
const SurfaceMesh kSquare{{{3, 0, 0}, {3, 0, -2}, {3, 2, -2}, {3, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}};

Flattening FlatSquare() {
  Flattening flat;
  flat.uv = {{0, 0}, {0, 2}, {-2, 2}, {-2, 0}};  // a quarter turn
  flat.source = {0, 1, 2, 3};
  flat.corner_uv = kSquare.triangles;
  flat.singular_values = {{1, 1}, {1.02, 1}};
  return flat;
}

std::size_t Count(const std::string& text, const std::string& piece) {
  std::size_t count = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + 1)) {
    ++count;
  }
  return count;
}

TEST(FrontView, LooksAlongTheMeanNormal) {
  const FrontView front(kSquare);
  const std::vector<Complex>& p = front.points();
  ASSERT_EQ(p.size(), 4u);
  EXPECT_NEAR(std::abs(p[1] - p[0] - Complex(2, 0)), 0, 1e-12);  // to the right
  EXPECT_NEAR(std::abs(p[2] - p[1] - Complex(0, 2)), 0, 1e-12);  // up
  EXPECT_NEAR(front.Depth(0), 3, 1e-12);
}

TEST(CheckeredSurface, CoversHalfOfItWithDarkSquares) {
  const FrontView front(kSquare);
  Bounds bounds;
  bounds.Add(front.points());
  const View view(bounds, 0, 0, 200, 200);
  const Flattening flat = FlatSquare();
  const std::string svg =
      CheckeredSurface(kSquare, front, flat.uv, flat.corner_uv, /*square=*/1, view);
  // Of four squares the diagonal goes through the light ones, so each triangle has one dark one.
  EXPECT_EQ(Count(svg, "<path"), 2u);
  const std::string dark = svg.substr(svg.rfind("<path"));
  EXPECT_EQ(Count(dark, "z"), 2u);
  EXPECT_THAT(dark, HasSubstr("M100 200l100 0"));
}

TEST(CheckeredSurface, EndsWhereOneMoreIsNoLarger) {
  const FrontView front(kSquare);
  Bounds bounds;
  bounds.Add(front.points());
  Flattening flat = FlatSquare();
  for (Complex& p : flat.uv) p += Complex(1e20, 1e20);
  const std::string svg = CheckeredSurface(kSquare, front, flat.uv, flat.corner_uv, /*square=*/1,
                                           View(bounds, 0, 0, 200, 200));
  EXPECT_EQ(Count(svg, "<path"), 1u);
}

TEST(Comparison, APanelWithoutALayoutShowsItsLinesAlone) {
  const std::vector<ComparisonPanel> panels{{"unrolled", FlatSquare(), {"nothing is bent"}},
                                            {"impossible", {}, {"it cannot be unfolded"}}};
  const std::string svg = FormatComparison(kSquare, panels, "caption");
  for (const ComparisonPanel& panel : panels) EXPECT_THAT(svg, HasSubstr(">" + panel.label + "<"));
  EXPECT_THAT(svg, HasSubstr("nothing is bent"));
  EXPECT_THAT(svg, HasSubstr("it cannot be unfolded"));
  EXPECT_THAT(svg, HasSubstr("+2 %"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  // Four triangles on the surface and one dark square in each of two; two shades and the outline.
  EXPECT_EQ(Count(svg, "<path"), 2u + 2u + 1u);
}

}  // namespace
}  // namespace arap
