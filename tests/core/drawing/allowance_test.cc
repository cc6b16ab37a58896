// Seam allowances: where they go, what they lose, and what they may cost.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "core/drawing/pattern_steps.h"

namespace arap {
namespace {

using testing::ElementsAre;

// With all that a drawing may cost.
Allowance Made(const std::vector<Ring>& rings, double width, Corners corners = Corners::kMitre) {
  BorderBudget budget;
  Result<Allowance> made = OffsetOutwards(rings, width, corners, budget);
  EXPECT_TRUE(made) << made.error().message;
  return made ? *std::move(made) : Allowance();
}
std::vector<Ring> Offset(const std::vector<Ring>& rings, double width) {
  return Made(rings, width).rings;
}

double Area(const Ring& line) {
  double twice = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    twice += (std::conj(line[i]) * line[(i + 1) % line.size()]).imag();
  }
  return twice / 2;
}

TEST(Allowance, OfARectangleIsALargerOne) {
  const auto rings = Offset({{{0, 0}, {100, 0}, {100, 50}, {0, 50}}}, 10);
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_THAT(rings[0], ElementsAre(Complex(110, 60), Complex(-10, 60), Complex(-10, -10),
                                    Complex(110, -10)));
}

TEST(Allowance, HolesShrinkAndVanish) {
  const Ring outer{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  EXPECT_THAT(Offset({outer, {{30, 30}, {30, 70}, {70, 70}, {70, 30}}}, 10),
              ElementsAre(testing::_, ElementsAre(Complex(60, 60), Complex(60, 40), Complex(40, 40),
                                                  Complex(40, 60))));
  EXPECT_EQ(Offset({outer, {{40, 30}, {40, 70}, {60, 70}, {60, 30}}}, 10).size(), 1u);
}

TEST(Allowance, FillsANarrowSlotWithoutCrossingItself) {
  const auto rings = Offset(
      {{{0, 0}, {100, 0}, {100, 100}, {55, 100}, {55, 20}, {45, 20}, {45, 100}, {0, 100}}}, 10);
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_EQ(rings[0].size(), 4u);  // a square
}

TEST(Allowance, OfAFineOutlineCostsLittle) {
  constexpr std::size_t kPoints = 20'000;
  constexpr double kRadius = 300, kWidth = 100;
  Ring circle;
  for (std::size_t i = 0; i < kPoints; ++i) {
    circle.push_back(std::polar(kRadius, 2 * std::numbers::pi * static_cast<double>(i) / kPoints));
  }
  BorderBudget budget;
  const Result<Allowance> made = OffsetOutwards({circle}, kWidth, Corners::kMitre, budget);
  ASSERT_TRUE(made);
  const std::vector<Ring>& rings = made->rings;
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_NEAR(Area(rings[0]), std::numbers::pi * std::pow(kRadius + kWidth, 2), 10);
  EXPECT_LT(BorderBudget().left - budget.left, 100 * kPoints);
}

// An eight: what is gone round the other way keeps an allowance too.
TEST(Allowance, OfAnOutlineThatCrossesItselfIsDrawn) {
  const auto rings = Offset({{{0, 0}, {100, 100}, {100, 0}, {0, 100}}}, 5);
  Bounds box;
  for (const Ring& ring : rings) box.Add(ring);
  EXPECT_GE(box.width(), 100);
  EXPECT_LE(box.width(), 120);
}

// Of every point of the border the distance to the outline is the width, at most the limit of the
// corners more.
TEST(Allowance, KeepsItsWidthRoundASharpAndAHollowCorner) {
  const Ring arrow{{0, 0}, {60, -8}, {20, 0}, {60, 8}};
  constexpr double kWidth = 5;
  const auto rings = Offset({arrow}, kWidth);
  ASSERT_EQ(rings.size(), 1u);
  const Ring& border = rings[0];
  const auto distance = [&](Complex p) {
    double least = INFINITY;
    for (std::size_t i = 0; i < arrow.size(); ++i) {
      const Complex a = arrow[i], side = arrow[(i + 1) % arrow.size()] - a;
      const double along = (std::conj(side) * (p - a)).real() / std::norm(side);
      least = std::min(least, std::abs(p - a - std::clamp(along, 0.0, 1.0) * side));
    }
    return least;
  };
  const std::size_t n = border.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (int k = 0; k < 20; ++k) {
      const double t = k / 20.0;
      const Complex p = border[i] + t * (border[(i + 1) % n] - border[i]);
      EXPECT_GE(distance(p), kWidth - 0.01) << p;
      // The end of a cut corner lies beside the axis that the limit is measured on.
      EXPECT_LE(distance(p), 2.3 * kWidth) << p;
    }
  }
}

// Where two sides are nearer than twice the width, and wherever else an allowance has no room.
TEST(Allowance, WhatItLosesIsMeasured) {
  const Ring square{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  const auto hole = [](double r) -> Ring {
    return {{50 - r, 50 - r}, {50 - r, 50 + r}, {50 + r, 50 + r}, {50 + r, 50 - r}};
  };
  // A slot from above, so wide and so deep.
  const auto slot = [](double wide, double deep) -> Ring {
    return {{0, 0},
            {100, 0},
            {100, 100},
            {50 + wide / 2, 100},
            {50 + wide / 2, 100 - deep},
            {50 - wide / 2, 100 - deep},
            {50 - wide / 2, 100},
            {0, 100}};
  };
  // A dart from above with this half angle.
  const auto dart = [](double degrees) -> Ring {
    const double half = 40 * std::tan(degrees * std::numbers::pi / 180);
    return {{0, 0}, {100, 0}, {100, 100}, {50 + half, 100}, {50, 60}, {50 - half, 100}, {0, 100}};
  };
  constexpr double kWidth = 5;
  struct Case {
    const char* what;
    std::vector<Ring> rings;
    double least, most;
  };
  const std::vector<Case> cases{
      {"nothing narrow", {square}, 0, 0},
      {"a wide hole", {square, hole(20)}, 0, 0},
      {"a hole that vanishes", {square, hole(4)}, 32, 32},
      {"a wide slot", {slot(30, 50)}, 0, 0},
      {"a narrow slot", {slot(1, 50)}, 98, 101},
      {"a slot that two allowances fill", {slot(8, 50)}, 98, 108},
      {"a slit", {slot(0, 50)}, 98, 100},
      {"a right angle that is hollow", {dart(45)}, 0, 0},
      {"a dart", {dart(25)}, 0, 0},
      {"a sharp dart", {dart(5)}, 60, 81},
  };
  for (const Case& one : cases) {
    const double lost = Made(one.rings, kWidth).lost.value_or(-1);
    EXPECT_GE(lost, one.least - 1e-3) << one.what;
    EXPECT_LE(lost, one.most + 1e-3) << one.what;
  }
  // Turned and moved it is the same.
  Ring turned = slot(1, 50);
  for (Complex& p : turned) p = std::polar(1.0, 0.7) * p + Complex(1e4, -3e3);
  EXPECT_NEAR(Made({turned}, kWidth).lost.value_or(-1),
              Made({slot(1, 50)}, kWidth).lost.value_or(-2), 1e-3);
}

TEST(Allowance, RoundAndSquareCornersEndAtTheWidth) {
  const Ring square{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  const double mitred = Area(Made({square}, 10).rings[0]);
  EXPECT_NEAR(mitred, 120 * 120, 1e-6);
  const double round = Area(Made({square}, 10, Corners::kRound).rings[0]);
  EXPECT_NEAR(round, 100 * 100 + 4 * 1000 + 100 * std::numbers::pi, 0.5);
  EXPECT_LT(round, 100 * 100 + 4 * 1000 + 100 * std::numbers::pi);
  // The diagonal is cut at the width: four triangles less than the mitred one.
  const double leg = (std::sqrt(2) - 1) * 10 * std::sqrt(2);
  EXPECT_NEAR(Area(Made({square}, 10, Corners::kSquare).rings[0]), mitred - 2 * leg * leg, 1e-3);
}

// All pieces of a drawing share what it may cost.
TEST(Allowance, IsRefusedWhenTheBudgetIsSpent) {
  const Ring sheet{{0, 0}, {100, 0}, {100, 50}, {0, 50}};
  BorderBudget spent{3};
  EXPECT_FALSE(OffsetOutwards({sheet}, 10, Corners::kMitre, spent));
  // What it has lost is found out from a budget of its own.
  BorderBudget scarce;
  scarce.left_to_check = 3;
  const auto made = OffsetOutwards({sheet}, 10, Corners::kMitre, scarce);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->rings.size(), 1u);
  EXPECT_FALSE(made->lost);
}

}  // namespace
}  // namespace arap
