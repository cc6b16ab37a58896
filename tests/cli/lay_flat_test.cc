// Several methods side by side, without a server.
#include "client/cli/commands/lay_flat.h"

#include <gmock/gmock.h>

#include "client/cli/commands/flatten_report.h"
#include "core/drawing/comparison.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

const SurfaceMesh kSquare{{{3, 0, 0}, {3, 0, -2}, {3, 2, -2}, {3, 2, 0}}, {{0, 1, 2}, {0, 2, 3}}};

client::FlatSurface FlatSquare() {
  client::FlatSurface answer;
  Flattening& flat = answer.flat;
  flat.uv = {{0, 0}, {0, 2}, {-2, 2}, {-2, 0}};  // a quarter turn
  flat.source = {0, 1, 2, 3};
  flat.corner_uv = {{0, 1, 2}, {0, 2, 3}};
  flat.singular_values = {{1, 1}, {1.02, 1}};
  return answer;
}

TEST(Comparison, MethodsThatFailSayWhy) {
  std::vector<client::FlattenQuery> asked;
  client::FlattenQuery base;
  base.options.cut.auto_cut = true;
  base.options.cut.seams = {{0, 2}};
  const auto panels =
      CompareMethods(base, [&](const client::FlattenQuery& query, const std::string&) {
        asked.push_back(query);
        return query.options.injective ? Result<client::FlatSurface>(Fail(FaultKind::kInvalidOption,
                                                                          "it cannot be unfolded"))
                                       : FlatSquare();
      });
  ASSERT_TRUE(panels) << panels.error().message;
  EXPECT_EQ(asked.size(), 6u);
  for (const client::FlattenQuery& query : asked) EXPECT_EQ(query.options.cut, base.options.cut);
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
    return [&calls, kind](const client::FlattenQuery&, const std::string&) {
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
