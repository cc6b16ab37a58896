// Where pieces lie: rolls that are as narrow as they have to be, and grain lines that stay parallel.
#include <cmath>
#include <random>

#include <gmock/gmock.h>

#include "core/drawing/pattern_steps.h"

namespace arap {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

void AddRectangle(double width, double height, bool grain, Pattern& pattern) {
  const auto piece = static_cast<std::uint32_t>(pattern.pieces.size());
  const std::vector<Complex> corners{{0, 0}, {width, 0}, {width, height}, {0, height}};
  PatternPiece& made = pattern.pieces.emplace_back();
  made.box.Add(corners);
  made.lines.push_back({LineKind::kOutline, true, corners});
  if (grain) made.lines.push_back({LineKind::kGrain, false, {corners[0], corners[1]}});
  made.labels.push_back({{width / 2, height / 2}, 3, "in the middle"});
  for (const Complex p : corners) {
    pattern.points.push_back(p);
    pattern.piece_of.push_back(piece);
  }
}

// Nothing overlaps, everything of a piece has moved alike, and grain lines run along x.
void CheckRoll(const Pattern& pattern, double width) {
  for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
    const PatternPiece& piece = pattern.pieces[i];
    EXPECT_GE(piece.box.min_y, -1e-9);
    EXPECT_LE(piece.box.max_y, width + 1e-6);
    Bounds outline;
    outline.Add(piece.lines[0].points);
    EXPECT_EQ(outline.min_x, piece.box.min_x);
    EXPECT_EQ(outline.max_y, piece.box.max_y);
    EXPECT_EQ(pattern.points[4 * i], piece.lines[0].points[0]);
    const Complex middle = (piece.lines[0].points[0] + piece.lines[0].points[2]) / 2.0;
    EXPECT_LE(std::abs(piece.labels[0].at - middle), 1e-9);
    if (piece.lines.size() > 1) {
      const Complex along = piece.lines[1].points[1] - piece.lines[1].points[0];
      EXPECT_GT(along.real(), 0);
      EXPECT_EQ(along.imag(), 0);
    }
    for (std::size_t k = 0; k < i; ++k) {
      const Bounds &a = piece.box, &b = pattern.pieces[k].box;
      const double x = std::max(a.min_x - b.max_x, b.min_x - a.max_x);
      const double y = std::max(a.min_y - b.max_y, b.min_y - a.max_y);
      EXPECT_GE(std::max(x, y), 5 - 1e-9) << i << ' ' << k;
    }
  }
}

TEST(Roll, HoldsPiecesOfAllKinds) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(10, 400);
  Pattern pattern;
  double area = 0;
  for (int i = 0; i < 60; ++i) {
    const double width = side(random), height = side(random);
    AddRectangle(width, height, i % 3 == 0, pattern);
    area += width * height;
  }
  ASSERT_TRUE(PackRoll(900, pattern));
  CheckRoll(pattern, 900);
  EXPECT_LT(pattern.Box().width() * 900, 1.5 * area);
}

TEST(Roll, PiecesWithoutGrainAreTurnedWhereThatHelps) {
  Pattern pattern;
  for (int i = 0; i < 4; ++i) AddRectangle(500, 100, false, pattern);
  ASSERT_TRUE(PackRoll(500, pattern));
  CheckRoll(pattern, 500);
  // Across the roll: 4 × 100 and three gaps. Along it they would need 500.
  EXPECT_NEAR(pattern.Box().width(), 415, 1e-9);
  Pattern with_grain;
  for (int i = 0; i < 4; ++i) AddRectangle(500, 100, true, with_grain);
  ASSERT_TRUE(PackRoll(500, with_grain));
  CheckRoll(with_grain, 500);
  EXPECT_NEAR(with_grain.Box().width(), 500, 1e-9);
}

TEST(Roll, WhatFitsNeitherWayIsNamed) {
  Pattern pattern;
  AddRectangle(300, 50, false, pattern);
  AddRectangle(300, 250, true, pattern);
  const Status refused = PackRoll(200, pattern);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().field, "sheet_width");
  EXPECT_THAT(refused.error().message,
              HasSubstr("Piece 2 needs 250.0 mm across the roll, as its grain line runs"));
  Pattern narrow;
  AddRectangle(100, 300, false, narrow);
  ASSERT_TRUE(PackRoll(100, narrow));  // as wide as the roll, on its side or not
  CheckRoll(narrow, 300);
  EXPECT_FALSE(PackRoll(99, narrow));
  Pattern nothing;
  EXPECT_TRUE(PackRoll(100, nothing));
}

// A square of 40 cut along its diagonal, the second half moved away, each with one notch.
TEST(Notches, PairBothSidesOfASeam) {
  Flattening flat;
  flat.uv = {{0, 0}, {40, 0}, {40, 40}, {100, 40}, {100, 0}, {140, 40}};
  flat.source = {0, 1, 2, 3, 0, 2};
  flat.corner_uv = {{0, 1, 2}, {4, 5, 3}};
  flat.triangle_chart = {0, 1};
  flat.cuts = {{2, 0}};
  flat.charts.resize(2);
  flat.charts[0].loops = {{0, 1, 2}};
  flat.charts[1].loops = {{4, 5, 3}};
  const auto notches = [&](double allowance) {
    PatternOptions options;
    options.notches = true;
    options.allowance = allowance;
    const auto made = MakePattern(flat, options);
    EXPECT_TRUE(made);
    std::vector<PatternLine> found;
    for (const PatternPiece& piece : made->pieces) {
      EXPECT_EQ(piece.labels.size(), 1u);
      EXPECT_EQ(piece.labels[0].text, "1");
      for (const PatternLine& line : piece.lines) {
        if (line.kind == LineKind::kNotch) found.push_back(line);
      }
    }
    EXPECT_EQ(found.size(), 2u);
    return found;
  };
  const auto inside = notches(0);
  ASSERT_EQ(inside.size(), 2u);
  EXPECT_LE(std::abs(inside[0].points[0] - Complex(20, 20)), 1e-9);
  EXPECT_LE(std::abs(inside[1].points[0] - Complex(120, 20)), 1e-9);
  // Into the pieces: below the diagonal and above it.
  EXPECT_LT(inside[0].points[1].imag(), 20);
  EXPECT_GT(inside[1].points[1].imag(), 20);
  EXPECT_NEAR(std::abs(inside[0].points[1] - inside[0].points[0]), 4, 1e-9);
  // Into the allowance, and not beyond it.
  const auto outside = notches(3);
  ASSERT_EQ(outside.size(), 2u);
  EXPECT_GT(outside[0].points[1].imag(), 20);
  EXPECT_NEAR(std::abs(outside[0].points[1] - outside[0].points[0]), 3, 1e-9);
}

// A strip whose three seams of two edges each go to three other pieces is numbered stretch by
// stretch; a slit into a piece has one number on both of its sides.
TEST(Notches, AStretchEndsWhereAnotherPieceBegins) {
  Flattening flat;
  // The lower strip: 0…4 along the top from right to left, below it 5 and 6.
  flat.uv = {{80, 0},
             {60, 0},
             {40, 0},
             {20, 0},
             {0, 0},
             {0, -20},
             {80, -20},
             // two pieces above it, moved up
             {40, 10},
             {60, 10},
             {80, 10},
             {80, 30},
             {40, 30},
             {0, 10},
             {20, 10},
             {40, 10},
             {40, 30},
             {0, 30}};
  flat.source = {0, 1, 2, 3, 4, 5, 6, 2, 1, 0, 7, 8, 4, 3, 2, 8, 9};
  flat.charts.resize(3);
  flat.charts[0].loops = {{0, 1, 2, 3, 4, 5, 6}};
  flat.charts[1].loops = {{7, 8, 9, 10, 11}};
  flat.charts[2].loops = {{12, 13, 14, 15, 16}};
  flat.cuts = {{0, 1}, {1, 2}, {2, 3}, {3, 4}};
  PatternOptions options;
  options.notches = true;
  const auto made = MakePattern(flat, options);
  ASSERT_TRUE(made);
  std::vector<std::string> below;
  for (const PatternLabel& label : made->pieces[0].labels) below.push_back(label.text);
  EXPECT_THAT(below, ElementsAre("1", "2"));
  ASSERT_EQ(made->pieces[1].labels.size(), 1u);
  ASSERT_EQ(made->pieces[2].labels.size(), 1u);
  EXPECT_EQ(made->pieces[1].labels[0].text, "1");
  EXPECT_EQ(made->pieces[2].labels[0].text, "2");
  EXPECT_EQ(made->pieces[1].lines.back().points[0], Complex(60, 10));
  EXPECT_EQ(made->pieces[0].lines.back().points[0], Complex(20, 0));
}

TEST(Notches, BothSidesOfASlitHaveOneNumber) {
  Flattening flat;
  flat.uv = {{0, 0}, {20, 0}, {40, 0}, {40, 40}, {0, 40}, {20, 20}, {20, 0}};
  flat.source = {0, 1, 2, 3, 4, 5, 1};
  flat.cuts = {{1, 5}};
  flat.charts.resize(1);
  flat.charts[0].loops = {{0, 1, 5, 6, 2, 3, 4}};
  PatternOptions options;
  options.notches = true;
  const auto made = MakePattern(flat, options);
  ASSERT_TRUE(made);
  ASSERT_EQ(made->pieces[0].labels.size(), 2u);
  EXPECT_EQ(made->pieces[0].labels[0].text, "1");
  EXPECT_EQ(made->pieces[0].labels[1].text, "1");
}

}  // namespace
}  // namespace arap
