// Pages: joined at their marks they give the sheet, and PDF and SVG have them at true size.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <gmock/gmock.h>

#include "core/drawing/page.h"
#include "core/drawing/pattern_files.h"
#include "core/drawing/svg.h"

namespace arap {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr Paper kA4{210, 297, true};

// A piece with one closed line.
Pattern Outlined(std::vector<Complex> line) {
  Pattern pattern;
  PatternPiece& piece = pattern.pieces.emplace_back();
  piece.box.Add(line);
  piece.lines.push_back({LineKind::kOutline, /*closed=*/true, std::move(line)});
  return pattern;
}

Pattern Rectangle(double width, double height) {
  const std::vector<Complex> corners{
      {-5, 7}, {width - 5, 7}, {width - 5, height + 7}, {-5, height + 7}};
  Pattern pattern = Outlined(corners);
  pattern.points = corners;
  pattern.triangles = {{0, 1, 2}, {0, 2, 3}};
  return pattern;
}

std::vector<Page> Tiled(const Pattern& pattern, const Paper& paper = kA4, double overlap = 10) {
  const auto pages = TilePages(pattern, paper, overlap);
  EXPECT_TRUE(pages) << pages.error().message;
  return pages ? *pages : std::vector<Page>();
}

TEST(Paper, IsReadByNameOrSize) {
  const auto is = [](const char* text, double width, double height, bool either_way) {
    const auto paper = ParsePaper(text);
    return paper && paper->width == width && paper->height == height &&
           paper->either_way == either_way;
  };
  EXPECT_TRUE(is("A4", 210, 297, true));
  EXPECT_TRUE(is("A3", 297, 420, true));
  EXPECT_TRUE(is("A0", 841, 1189, true));
  EXPECT_TRUE(is("letter", 215.9, 279.4, true));
  EXPECT_TRUE(is("914x1500.5", 914, 1500.5, false));
  for (const char* wrong : {"", "A9", "a4x", "210", "x", "210x", "x297", "210x297mm", "nanx297",
                            "99x297", "210x5081", "-210x297", "210x297x3"}) {
    EXPECT_FALSE(ParsePaper(wrong)) << wrong;
  }
}

// The middles of the marks of a page by their labels: the label stands beside.
std::multimap<std::string, Complex> Marks(const Page& page) {
  std::multimap<std::string, Complex> marks;
  for (const PageText& text : page.texts) {
    if (text.text.find('/') != std::string::npos) marks.emplace(text.text, text.at);
  }
  return marks;
}

TEST(Tiling, PagesJoinedAtTheirMarksGiveTheSheet) {
  constexpr double kWidth = 607, kHeight = 622;
  const std::vector<Page> pages = Tiled(Rectangle(kWidth, kHeight));
  ASSERT_EQ(pages.size(), 13u);  // a cover and 4 × 3
  // Where each page lies when the first lies at 0, found from the marks alone.
  std::map<std::size_t, Complex> places{{1, 0}};
  for (std::size_t round = 0; round < pages.size(); ++round) {
    for (std::size_t a = 1; a < pages.size(); ++a) {
      for (std::size_t b = 1; b < pages.size(); ++b) {
        const std::string label =
            std::to_string(std::min(a, b)) + "/" + std::to_string(std::max(a, b));
        if (a == b || !places.contains(a)) continue;
        const auto on_a = Marks(pages[a]), on_b = Marks(pages[b]);
        ASSERT_EQ(on_a.count(label), on_b.count(label));
        if (on_a.count(label) == 0) continue;
        ASSERT_EQ(on_a.count(label), 2u);
        const Complex first = on_a.find(label)->second - on_b.find(label)->second;
        const Complex second =
            std::next(on_a.find(label))->second - std::next(on_b.find(label))->second;
        EXPECT_LE(std::abs(first - second), 1e-9) << "the page would be turned";
        const auto [known, fresh] = places.try_emplace(b, places[a] + first);
        EXPECT_LE(std::abs(known->second - (places[a] + first)), 1e-9);
      }
    }
  }
  ASSERT_EQ(places.size(), 12u);
  // The outline from the parts on all pages, as far as each page shows them.
  Bounds box;
  std::vector<std::pair<Complex, Complex>> shown;
  for (std::size_t i = 1; i < pages.size(); ++i) {
    for (const PageLine& line : pages[i].drawing) {
      for (std::size_t k = 0; k + 1 < line.points.size(); ++k) {
        const auto clamped = [&](Complex p) {
          const Bounds& w = pages[i].window;
          return places[i] + Complex(std::clamp(p.real(), w.min_x, w.max_x),
                                     std::clamp(p.imag(), w.min_y, w.max_y));
        };
        shown.emplace_back(clamped(line.points[k]), clamped(line.points[k + 1]));
        box.Add(shown.back().first);
        box.Add(shown.back().second);
      }
    }
  }
  EXPECT_NEAR(box.width(), kWidth, 1e-9);
  EXPECT_NEAR(box.height(), kHeight, 1e-9);
  for (double t = 0.5; t < kWidth; ++t) {
    for (const double y : {box.min_y, box.max_y}) {
      const bool found = std::any_of(shown.begin(), shown.end(), [&](const auto& segment) {
        const double a = segment.first.real() - box.min_x, b = segment.second.real() - box.min_x;
        return std::abs(segment.first.imag() - y) < 1e-9 &&
               std::abs(segment.second.imag() - y) < 1e-9 && std::min(a, b) <= t &&
               std::max(a, b) >= t;
      });
      EXPECT_TRUE(found) << t << ' ' << y;
    }
  }
}

TEST(Tiling, EveryPageHasItsNumberAndTheCoverASquareOf50) {
  const std::vector<Page> pages = Tiled(Rectangle(300, 100));
  ASSERT_EQ(pages.size(), 3u);
  EXPECT_EQ(pages[1].width, 210);  // two upright ones are as few as two on their sides
  for (std::size_t i = 1; i < pages.size(); ++i) {
    EXPECT_EQ(pages[i].texts.back().text,
              "page " + std::to_string(i) + " of 2: row 1, column " + std::to_string(i));
  }
  EXPECT_TRUE(std::any_of(pages[0].lines.begin(), pages[0].lines.end(), [](const PageLine& line) {
    return line.closed && std::abs(line.points[1] - line.points[0]) == 50 &&
           std::abs(line.points[2] - line.points[1]) == 50;
  }));
  for (const Page& page : pages) {
    for (const PageLine& line : page.lines) {
      for (const Complex p : line.points) {
        EXPECT_GE(std::min(p.real(), p.imag()), 5);
        EXPECT_LE(p.real(), page.width - 5);
        EXPECT_LE(p.imag(), page.height - 5);
      }
    }
  }
  // What fits needs one page only, and no marks; it may lie on its side.
  const std::vector<Page> one = Tiled(Rectangle(270, 180));
  ASSERT_EQ(one.size(), 2u);
  EXPECT_EQ(one[1].width, 297);
  EXPECT_TRUE(Marks(one[1]).empty());
  ASSERT_EQ(one[1].drawing.size(), 1u);
  EXPECT_TRUE(one[1].drawing[0].closed);
  EXPECT_EQ(Tiled(Rectangle(270, 180), {210, 297, false}).size(), 3u);
}

TEST(Tiling, APageHasOnlyWhatItShows) {
  // A long zigzag: its points are on one or two pages each.
  std::vector<Complex> zigzag;
  for (int i = 0; i < 2000; ++i) zigzag.emplace_back(i, i % 2);
  std::size_t points = 0;
  for (const Page& page : Tiled(Outlined(zigzag), {1000, 200, false})) {
    for (const PageLine& line : page.drawing) points += line.points.size();
  }
  EXPECT_LT(points, 2u * 2000 + 2000);
}

// Two pieces far from each other along a diagonal: between them there is nothing to print.
TEST(Tiling, PagesThatWouldBeBlankAreLeftOut) {
  Pattern pattern = Outlined({{0, 0}, {80, 0}, {80, 80}, {0, 80}});
  pattern.pieces.push_back(
      Outlined({{920, 920}, {1000, 920}, {1000, 1000}, {920, 1000}}).pieces[0]);
  pattern.pieces[1].labels.push_back({{960, 960}, 5, "right", true});
  const std::vector<Page> pages = Tiled(pattern, {270, 270, false});
  // 5 rows of 5, numbered as if all of them were there.
  ASSERT_EQ(pages.size(), 3u);
  EXPECT_EQ(pages[0].number, 0u);
  EXPECT_EQ(pages[1].number, 5u);
  EXPECT_EQ(pages[1].texts.back().text, "page 5 of 25: row 1, column 5");
  EXPECT_EQ(pages[1].texts.front().text, "right");
  EXPECT_EQ(pages[2].number, 21u);
  for (const Page& page : pages) EXPECT_TRUE(Marks(page).empty()) << "there is nothing to join";
  EXPECT_TRUE(std::any_of(pages[0].texts.begin(), pages[0].texts.end(), [](const PageText& text) {
    return text.text.starts_with("2 pages in 5 rows of 5, those that would be blank left out");
  }));
  const auto dashed = std::count_if(pages[0].lines.begin(), pages[0].lines.end(),
                                    [](const PageLine& line) { return line.ink.dashed; });
  EXPECT_EQ(dashed, 23) << "of the overview";
}

// Inside of a piece there is nothing to see, but paper that is cut out with it.
TEST(Tiling, PagesInsideOfAPieceAreKept) {
  EXPECT_EQ(Tiled(Rectangle(1000, 1000)).size(), 1u + 6 * 4);
  // A frame of four rectangles round nothing.
  Pattern frame = Outlined({{0, 0}, {1000, 0}, {1000, 1000}, {0, 1000}});
  frame.points = {{0, 0},   {1000, 0}, {1000, 1000}, {0, 1000},
                  {50, 50}, {950, 50}, {950, 950},   {50, 950}};
  frame.pieces[0].lines.push_back(
      {LineKind::kOutline, true, {frame.points.begin() + 4, frame.points.end()}});
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    frame.triangles.push_back({k, next, next + 4});
    frame.triangles.push_back({k, next + 4, k + 4});
  }
  EXPECT_EQ(Tiled(frame).size(), 1u + 6 * 4 - 4 * 2);
}

TEST(Tiling, MarginsAreAsAskedFor) {
  for (const double margin : {0.0, 5.0, 20.0}) {
    const auto pages = TilePages(Rectangle(300, 300), kA4, 10, margin);
    ASSERT_TRUE(pages) << margin;
    EXPECT_EQ((*pages)[1].window.min_x, margin);
    EXPECT_EQ((*pages)[1].window.max_y, (*pages)[1].height - margin);
    const PageText& number = (*pages)[1].texts.back();
    EXPECT_GT(number.at.imag(), 1);
    EXPECT_LT(number.at.imag(), margin + 3);
  }
  const auto refused = TilePages(Rectangle(300, 300), kA4, 10, 21);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().field, "margin");
}

// What PDF cannot say of places that are far away would bend lines that go there.
TEST(Tiling, PagesHaveNoPlacesThatAreFarFromThem) {
  const std::vector<Page> pages =
      Tiled(Outlined({{0, 0}, {5000, 4000}, {4900, 4100}}), {500, 500, false});
  for (const Page& page : pages) {
    for (const PageLine& line : page.drawing) {
      for (const Complex p : line.points) {
        EXPECT_GT(std::min(p.real(), p.imag()), 0);
        EXPECT_LT(std::max(p.real(), p.imag()), 500);
      }
    }
  }
}

TEST(Tiling, ManyLinesAcrossManyPagesAreRefused) {
  std::vector<Complex> comb;
  for (int i = 0; i < 6000; ++i) comb.emplace_back(i % 2 == 0 ? 0 : 7000, i);
  const auto refused = TilePages(Outlined(comb), {210, 297, false}, 10);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().field, "paper");
  EXPECT_THAT(refused.error().message, HasSubstr("parts"));
  EXPECT_TRUE(TilePages(Outlined(comb), {3000, 3000, false}, 10));
}

TEST(Tiling, WhatPaperCannotHoldIsRefused) {
  const auto many = TilePages(Rectangle(1e5, 1e5), kA4, 10);
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().field, "paper");
  EXPECT_THAT(many.error().message, HasSubstr("at most 1000"));
  EXPECT_FALSE(TilePages(Rectangle(1e300, 1), kA4, 10));
  for (const double overlap : {-1.0, 96.0, std::nan("")}) {
    const auto refused = TilePages(Rectangle(300, 300), kA4, overlap);
    ASSERT_FALSE(refused) << overlap;
    EXPECT_EQ(refused.error().field, "overlap");
  }
  EXPECT_TRUE(TilePages({}, kA4, 10));
}

TEST(Pdf, HasAllPagesAndNoDate) {
  const std::vector<Page> pages = Tiled(Rectangle(607, 622));
  const auto pdf = FormatPdf(pages);
  ASSERT_TRUE(pdf) << pdf.error().message;
  EXPECT_TRUE(pdf->starts_with("%PDF-"));
  EXPECT_THAT(*pdf, HasSubstr("/Count 13"));
  EXPECT_THAT(*pdf, Not(HasSubstr("Date")));
  EXPECT_EQ(*FormatPdf(pages), *pdf);
}

// The colours of strain as the SVG has them, with what they mean and the caption.
TEST(SheetPage, ColoursAndEdgesInsideAreAsAskedFor) {
  Pattern pattern = Rectangle(40, 30);
  pattern.singular_values = {{1.04, 1}, {1, 0.97}};
  pattern.pieces[0].labels.push_back({{15, 22}, 5, "front", /*is_name=*/true});
  const Page plain = SheetPage(pattern);
  EXPECT_TRUE(plain.areas.empty() && plain.texts.empty());
  EXPECT_EQ(plain.drawing.size(), 1u);
  const Page page = SheetPage(pattern, {/*strain=*/true, /*interior=*/true, {"caption"}});
  EXPECT_EQ(page.drawing.size(), 2u);
  EXPECT_EQ(page.texts.front().text, "caption");
  EXPECT_EQ(page.texts.back().text, "front");
  EXPECT_TRUE(std::any_of(page.texts.begin(), page.texts.end(),
                          [](const PageText& text) { return text.text == "+5 %"; }));
  // The legend, and the two triangles at true size above it: one red, one blue.
  ASSERT_EQ(page.areas.size(), 2u * kStrainShades + 1 + 2);
  const PageArea &blue = page.areas[page.areas.size() - 2], &red = page.areas.back();
  EXPECT_GT(blue.rgb & 0xffu, blue.rgb >> 16u);
  EXPECT_GT(red.rgb >> 16u, red.rgb & 0xffu);
  ASSERT_EQ(red.triangles.size(), 1u);
  EXPECT_NEAR(std::abs(red.triangles[0][1] - red.triangles[0][0]), 40, 1e-9);
  EXPECT_GT(red.triangles[0][0].imag(), page.areas.front().triangles[0][2].imag());
  EXPECT_TRUE(FormatPdf({page}));
  EXPECT_THAT(FormatPageSvg(page, 3), HasSubstr("<path fill=\"#"));
}

TEST(Pdf, ShowsTheLettersOfWesternEurope) {
  for (const char* shown : {"", "plain", "Ärmel", "50 €", "‘…’ – Œ"}) EXPECT_TRUE(PdfShows(shown));
  for (const char* not_shown : {"μ", "袖", "łódź", "\xff", "\u0085"}) {
    EXPECT_FALSE(PdfShows(not_shown)) << not_shown;
  }
  // Letters that nobody would see are no fault.
  Page page = SheetPage(Rectangle(50, 50));
  page.texts.push_back({{10, 10}, 0, "none"});
  EXPECT_TRUE(FormatPdf({page}));
}

TEST(Pdf, PagesThatTheFormatDoesNotKnowAreRefused) {
  EXPECT_TRUE(FormatPdf({SheetPage(Rectangle(5000, 100))}));
  const auto refused = FormatPdf({SheetPage(Rectangle(6000, 100))});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().field, "paper");
}

TEST(PageSvg, IsInMillimetres) {
  const std::string svg = FormatPageSvg(SheetPage(Rectangle(30, 20)), 3);
  EXPECT_THAT(svg, HasSubstr("width=\"50mm\" height=\"40mm\" viewBox=\"0 0 50 40\""));
  EXPECT_THAT(svg, HasSubstr("d=\"M10 30L40 30L40 10L10 10Z\""));
}

}  // namespace
}  // namespace arap
