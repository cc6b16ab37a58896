// Pieces are called as the parts of the surface that they are of.
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "core/base/code_point.h"
#include "core/drawing/captions.h"
#include "core/drawing/pattern_files.h"

namespace arap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// A layout in which triangle t is on chart charts[t].
Flattening OnCharts(std::vector<std::uint32_t> charts) {
  Flattening flat;
  for (const std::uint32_t chart : charts) {
    if (flat.charts.size() <= chart) flat.charts.resize(chart + 1);
  }
  flat.triangle_chart = std::move(charts);
  return flat;
}

using Parts = std::vector<NamedPart>;

TEST(PieceNames, MostTrianglesDecide) {
  const Flattening flat = OnCharts({0, 0, 0, 1, 1, 0});
  EXPECT_THAT(PieceNames(flat, Parts{}), IsEmpty());
  EXPECT_THAT(PieceNames(flat, Parts{{0, "front"}, {3, "back"}}), ElementsAre("front", "back"));
  // On the second piece both have one; the first of them counts, and then both pieces are front.
  EXPECT_THAT(PieceNames(flat, Parts{{1, "front"}, {4, "back"}}),
              ElementsAre("front 1", "front 2"));
}

TEST(PieceNames, PiecesOfOneNameAreNumbered) {
  const Flattening flat = OnCharts({0, 1, 2, 3});
  EXPECT_THAT(PieceNames(flat, Parts{{0, "sleeve"}, {2, "sleeve 1"}, {3, "sleeve"}}),
              ElementsAre("sleeve 2", "sleeve 3", "sleeve 1", "sleeve 4"));
  EXPECT_THAT(PieceNames(flat, Parts{{1, ""}, {2, "a"}}), ElementsAre("", "", "a 1", "a 2"));
}

TEST(PieceNames, AreClean) {
  const auto name = [](const std::string& from) {
    return PieceNames(OnCharts({0}), Parts{{0, from}}).at(0);
  };
  EXPECT_EQ(name("Ärmel <links> & 100 %"), "Ärmel <links> & 100 %");
  EXPECT_EQ(name("a\nb\x01\xff"), "a?b??");
  EXPECT_EQ(name("\u202egnp.exe"), "?gnp.exe");
  EXPECT_EQ(name(std::string(kLongestPieceName, 'x')), std::string(kLongestPieceName, 'x'));
  const std::string cut = name(std::string(62, 'x') + "ääää");
  EXPECT_EQ(cut, std::string(61, 'x') + "...");
  // Not in the middle of a character.
  EXPECT_EQ(name(std::string(60, 'x') + "äääää"), std::string(60, 'x') + "...");
}

TEST(PieceNames, PartsComeInOrder) {
  EXPECT_TRUE(CheckParts(Parts{{0, "a"}, {1, ""}, {9, "b"}}, 10));
  for (const Parts& wrong :
       {Parts{{10, "a"}}, Parts{{3, "a"}, {3, "b"}}, Parts{{3, "a"}, {2, "b"}}}) {
    const Status refused = CheckParts(wrong, 10);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().field,
              "parts[" + std::to_string(wrong.size() - 1) + "].first_triangle");
  }
}

// Two triangles of 40 × 40 mm, called as `names` say.
Pattern Called(const std::vector<std::string>& names) {
  Flattening flat = OnCharts({0, 1});
  flat.uv = {{0, 0}, {40, 0}, {40, 40}, {140, 40}, {100, 40}, {100, 0}};
  flat.source = {0, 1, 2, 3, 4, 5};
  flat.corner_uv = {{0, 1, 2}, {3, 4, 5}};
  flat.charts[0].loops = {{0, 1, 2}};
  flat.charts[1].loops = {{3, 4, 5}};
  PatternOptions options;
  options.names = names;
  const Result<Pattern> pattern = MakePattern(flat, options);
  EXPECT_TRUE(pattern);
  return pattern ? *pattern : Pattern();
}

TEST(PieceNames, AreWrittenOnThePieces) {
  const Pattern pattern = Called({"left & right", "ärmel\n∞"});
  EXPECT_EQ(pattern.pieces[1].name, "ärmel\n∞");
  EXPECT_THAT(FormatPattern(pattern, {true, false, {}}),
              HasSubstr("y=\"31.8\" font-size=\"5\">left &amp; right</text>"));
  EXPECT_THAT(FormatPattern(pattern, {false, false, {}}), Not(HasSubstr("left"))) << "plain";
  const std::string dxf = FormatDxf(pattern);
  EXPECT_THAT(dxf, HasSubstr("\nleft & right\n"));
  EXPECT_THAT(dxf, HasSubstr("\n\\U+00E4rmel?\\U+221E\n"));
}

TEST(PieceNames, AreNoCodesOfDxf) {
  const std::string dxf = FormatDxf(Called({"50%%d ^J", "\\U+0041 👗"}));
  EXPECT_THAT(dxf, HasSubstr("\n50% %d ^ J\n"));
  EXPECT_THAT(dxf, HasSubstr("\n\\U+005CU+0041 ?\n"));
}

TEST(CodePoint, ReadsUtf8AndNothingElse) {
  EXPECT_EQ(CodePoint("ä").value, 0xe4u);
  EXPECT_EQ(CodePoint("€x").length, 3u);
  EXPECT_EQ(CodePoint("\U0001f457").value, 0x1f457u);
  for (const char* bad : {"\x80", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe2\x82"}) {
    EXPECT_FALSE(CodePoint(bad).valid) << bad;
    EXPECT_EQ(CodePoint(bad).length, 1u) << bad;
  }
  EXPECT_FALSE(CodePoint("\uffff").IsHarmless()) << "no XML has it";
}

}  // namespace
}  // namespace arap
