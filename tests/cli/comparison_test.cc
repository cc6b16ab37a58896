// Several methods side by side, without a server.
#include "core/drawing/svg/comparison.h"

#include <cmath>

#include <gmock/gmock.h>

#include "client/cli/commands/compare.h"
#include "core/drawing/svg/front_view.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

// The square 2 × 2 in the plane x = 3, seen along x with y up: z goes to the left.
const client::SurfaceMesh kSquare{{3, 0, 0, 3, 0, -2, 3, 2, -2, 3, 2, 0}, {0, 1, 2, 0, 2, 3}};

client::FlatSurface FlatSquare() {
  client::FlatSurface flat;
  flat.uv = {0, 0, 0, 2, -2, 2, -2, 0};  // a quarter turn
  flat.uv_vertex = {0, 1, 2, 3};
  flat.corner_uv = kSquare.triangles;
  flat.singular_values = {1, 1, 1.02, 1};
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
  ASSERT_EQ(front.points().size(), 8u);
  const std::vector<double>& p = front.points();
  EXPECT_NEAR(p[2] - p[0], 2, 1e-12);  // to the right
  EXPECT_NEAR(p[3] - p[1], 0, 1e-12);
  EXPECT_NEAR(p[5] - p[3], 2, 1e-12);  // up
  EXPECT_NEAR(front.Depth(0), 3, 1e-12);
}

TEST(CheckeredSurface, CoversHalfOfItWithDarkSquares) {
  const FrontView front(kSquare);
  Bounds bounds;
  bounds.Add(front.points());
  const View view(bounds, 0, 0, 200, 200);
  const client::FlatSurface flat = FlatSquare();
  const std::string svg =
      CheckeredSurface(kSquare, front, flat.uv, flat.corner_uv, /*square=*/1, view);
  // Of four squares the diagonal goes through the light ones, so each triangle has one dark one.
  EXPECT_EQ(Count(svg, "<path"), 2u);
  const std::string dark = svg.substr(svg.rfind("<path"));
  EXPECT_EQ(Count(dark, "z"), 2u);
  EXPECT_THAT(dark, HasSubstr("M100 200l100 0"));
}

TEST(Comparison, MethodsThatFailSayWhy) {
  std::vector<client::FlattenOptions> asked;
  client::FlattenOptions base;
  base.auto_cut = true;
  base.seam_edges = {0, 2};
  const auto panels =
      CompareMethods(base, [&](const client::FlattenOptions& options, const std::string&) {
        asked.push_back(options);
        return options.injective ? Result<client::FlatSurface>(
                                       Fail(FaultKind::kInvalidOption, "it cannot be unfolded"))
                                 : FlatSquare();
      });
  ASSERT_TRUE(panels) << panels.error().message;
  EXPECT_EQ(asked.size(), 6u);
  for (const client::FlattenOptions& options : asked) {
    EXPECT_TRUE(options.auto_cut);
    EXPECT_EQ(options.seam_edges, base.seam_edges);
  }
  EXPECT_TRUE(panels->back().flat.uv.empty());
  const std::string svg = FormatComparison(kSquare, *panels, "caption");
  for (const ComparisonPanel& panel : *panels) EXPECT_THAT(svg, HasSubstr(">" + panel.label + "<"));
  EXPECT_THAT(svg, HasSubstr("it cannot be unfolded"));
  EXPECT_THAT(svg, HasSubstr("+2 %"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(FormatTable(*panels), HasSubstr("INVALID_OPTION"));
}

TEST(Comparison, FailsWhenAllDoOrTheCallerHasGoneAway) {
  int calls = 0;
  const auto fail = [&calls](FaultKind kind) {
    return [&calls, kind](const client::FlattenOptions&, const std::string&) {
      ++calls;
      return Result<client::FlatSurface>(Fail(kind, "no"));
    };
  };
  EXPECT_EQ(CompareMethods({}, fail(FaultKind::kNotADisk)).error().kind, FaultKind::kNotADisk);
  EXPECT_EQ(calls, 6);
  calls = 0;
  EXPECT_EQ(CompareMethods({}, fail(FaultKind::kCancelled)).error().kind, FaultKind::kCancelled);
  EXPECT_EQ(calls, 1);
}

}  // namespace
}  // namespace arap::cli
