// Answers that do not fit what was asked, and foreign text.
#include "client/cli/answers.h"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/cli/report.h"

namespace arap::cli {
namespace {

using testing::HasSubstr;

TEST(Answers, ShapesAreAsLongAsTheMeshAndFinite) {
  client::Shape shape;
  shape.positions = {{0, 0}, {1, 2}};
  EXPECT_TRUE(CheckShape(shape, 2));
  const Status wrong = CheckShape(shape, 3);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message, "The server answered a shape of 2 vertices; the mesh has 3.");
  for (const Complex bad : {Complex(NAN, 0), Complex(0, INFINITY)}) {
    shape.positions[1] = bad;
    EXPECT_THAT(CheckShape(shape, 2).error().message, HasSubstr("not finite"));
  }
}

const SurfaceMesh kTriangle{{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};

Flattening FlatTriangle() {
  Flattening flat;
  flat.uv = {{0, 0}, {3, 0}, {0, 4}};
  flat.source = {0, 1, 2};
  flat.corner_uv = {{0, 1, 2}};
  flat.singular_values = {{1, 1}};
  flat.triangle_chart = {0};
  flat.charts.resize(1);
  flat.charts[0].loops = {{0, 1, 2}};
  flat.cuts = {{0, 1}};
  flat.degenerate = {0};
  return flat;
}

TEST(Answers, LayoutsFitTheMesh) {
  EXPECT_TRUE(CheckLayout(FlatTriangle(), kTriangle));
  const auto refused = [](auto change) {
    Flattening flat = FlatTriangle();
    change(flat);
    return !CheckLayout(flat, kTriangle);
  };
  EXPECT_TRUE(refused([](auto& flat) { flat = {}; }));
  EXPECT_TRUE(refused([](auto& flat) { flat.corner_uv[0][1] = 3; }));
  EXPECT_TRUE(refused([](auto& flat) { flat.corner_uv[0] = {1, 0, 2}; }));
  EXPECT_TRUE(refused([](auto& flat) { flat.corner_uv.pop_back(); }));
  EXPECT_TRUE(refused([](auto& flat) { flat.uv.pop_back(); }));
  EXPECT_TRUE(refused([](auto& flat) { flat.uv[0] = {NAN, 0}; }));
  EXPECT_TRUE(refused([](auto& flat) { flat.source[0] = 3; }));
  EXPECT_TRUE(refused([](auto& flat) { flat.singular_values.clear(); }));
  EXPECT_TRUE(refused([](auto& flat) { flat.charts[0].loops[0][0] = 9; }));
  EXPECT_TRUE(refused([](auto& flat) { flat.charts.clear(); }));
  EXPECT_TRUE(refused([](auto& flat) { flat.triangle_chart.clear(); }));
  EXPECT_TRUE(refused([](auto& flat) { flat.cuts[0][0] = 3; }));
  EXPECT_TRUE(refused([](auto& flat) { flat.degenerate[0] = 1; }));
  EXPECT_TRUE(refused([](auto& flat) { flat.charts[0].anchors = {0, 3}; }));
}

TEST(Printable, LeavesWritingAlone) {
  for (const char* text : {"", "a plain sentence: 3 × 7 µs …", "čeština, 日本語, 😀"}) {
    EXPECT_EQ(Printable(text), text);
  }
}

TEST(Printable, ShowsWhatSteersATerminalOrHides) {
  EXPECT_EQ(Printable("\x1b]0;title\x07\x1b[2J"), "\\x1b]0;title\\x07\\x1b[2J");
  EXPECT_EQ(Printable("one\r\ntwo\ttabs"), "one\\x0d\\x0atwo\\x09tabs");
  EXPECT_EQ(Printable("\xc2\x9b"
                      "31m"),
            "\\x9b31m");                                               // CSI in one character
  EXPECT_EQ(Printable("\xe2\x80\xae\xe2\x81\xa6"), "\\u202e\\u2066");  // turned writing
  EXPECT_EQ(Printable("\xef\xbb\xbf"), "\\ufeff");
  EXPECT_EQ(Printable(std::string("a\0b", 3)), "a\\x00b");
}

TEST(Printable, ShowsBytesThatAreNoText) {
  EXPECT_EQ(Printable("\xff\xc0\xaf"), "\\xff\\xc0\\xaf");
  EXPECT_EQ(Printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // half of a pair
  EXPECT_EQ(Printable("\xe2\x82"), "\\xe2\\x82");           // cut off
  EXPECT_EQ(Printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
}

TEST(Printable, EndsWhatGoesOnForTooLong) {
  const std::string text = Printable(std::string(1'000'000, '\x1b'));
  EXPECT_LT(text.size(), 3000u);
  EXPECT_TRUE(text.ends_with("…"));
}

TEST(Printable, FaultsAndReportsAre) {
  Fault fault(FaultKind::kInternal, "\x1b[31mred");
  fault.Field("a\x1b").Detail("b\x1b", "c\x1b");
  EXPECT_EQ(Describe(fault).find('\x1b'), std::string::npos);
  const std::string text = JsonText({{"name", "\xe2\x80\xae\xff\x7f"}});
  EXPECT_TRUE(std::all_of(text.begin(), text.end(), [](char c) {
    return c == '\n' || (c >= ' ' && c <= '~');
  })) << testing::PrintToString(text);
}

}  // namespace
}  // namespace arap::cli
