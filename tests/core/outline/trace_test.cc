#include <numbers>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/plane.h"
#include "core/outline/outline.h"
#include "tests/core/outline/drawn.h"

namespace arap {
namespace {

using testing::AreaOf;
using testing::CountInside;
using testing::Drawn;
using testing::Noise;
using testing::Rows;

double FromSegment(Complex p, Complex a, Complex b) {
  const double along = std::clamp(Dot(p - a, b - a) / std::norm(b - a), 0.0, 1.0);
  return std::abs(p - a - along * (b - a));
}

double FromOutline(Complex p, const Outline& outline) {
  double distance = 1e9;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    distance = std::min(distance, FromSegment(p, outline[i], outline[(i + 1) % outline.size()]));
  }
  return distance;
}

// How far a point of `one` is from the other at most, by points along its lines.
double FurthestFrom(const Outline& one, const Outline& other) {
  constexpr int kSteps = 8;
  double furthest = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    for (int k = 0; k < kSteps; ++k) {
      const Complex p =
          one[i] + (one[(i + 1) % one.size()] - one[i]) * (static_cast<double>(k) / kSteps);
      furthest = std::max(furthest, FromOutline(p, other));
    }
  }
  return furthest;
}

std::size_t PointsOf(const std::vector<Outline>& outlines) {
  std::size_t count = 0;
  for (const Outline& outline : outlines) count += outline.size();
  return count;
}

// Whether any two lines of the outlines meet, other than neighbours in their common point.
bool AnyMeet(const std::vector<Outline>& outlines) {
  std::vector<std::array<Complex, 2>> lines;
  for (const Outline& outline : outlines) {
    for (std::size_t i = 0; i < outline.size(); ++i) {
      lines.push_back({outline[i], outline[(i + 1) % outline.size()]});
    }
  }
  const auto side = [](const auto& line, Complex p) {
    const double area = TwiceArea(line[0], line[1], p);
    return (area > 0) - (area < 0);
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    for (std::size_t k = i + 1; k < lines.size(); ++k) {
      const auto &a = lines[i], &b = lines[k];
      if (a[0] == b[1] || a[1] == b[0]) continue;
      if (side(a, b[0]) * side(a, b[1]) <= 0 && side(b, a[0]) * side(b, a[1]) <= 0 &&
          !(side(a, b[0]) == 0 && side(a, b[1]) == 0)) {
        return true;
      }
    }
  }
  return false;
}

TEST(TraceOutlines, APixelIsADiamondInItsPlace) {
  const auto outlines = TraceOutlines(Rows({"...", ".#.", "...", "..."}));
  ASSERT_TRUE(outlines);
  ASSERT_EQ(outlines->size(), 1u);
  const std::set<std::pair<double, double>> expected{{2, 2.5}, {1.5, 3}, {1, 2.5}, {1.5, 2}};
  std::set<std::pair<double, double>> points;
  for (const Complex p : (*outlines)[0]) points.emplace(p.real(), p.imag());
  EXPECT_EQ(points, expected);
  EXPECT_EQ(SignedArea((*outlines)[0]), 0.5);
}

TEST(TraceOutlines, PixelsThatTouchInACornerBelongTogetherAndHolesDoNot) {
  EXPECT_EQ(TraceOutlines(Rows({"#.", ".#"}))->size(), 1u);
  const auto holes = TraceOutlines(Rows({"####", "#.##", "##.#", "####"}));
  ASSERT_EQ(holes->size(), 3u);
  EXPECT_GT(SignedArea((*holes)[0]), 0);
  EXPECT_LT(SignedArea((*holes)[1]), 0);
  EXPECT_LT(SignedArea((*holes)[2]), 0);
}

TEST(TraceOutlines, AFullImageIsARectangle) {
  const auto outlines = TraceOutlines(Rows({"###", "###"}));
  ASSERT_TRUE(outlines);
  EXPECT_EQ(*outlines, std::vector<Outline>({{{0, 2}, {0, 0}, {3, 0}, {3, 2}}}));
}

TEST(TraceOutlines, OfNothingIsNothing) {
  EXPECT_TRUE(TraceOutlines(Rows({"...", "..."}))->empty());
}

// Between two corners of a pixel it cuts an eighth off, or adds one; an outline turns round once.
TEST(TraceOutlines, HaveTheAreaOfThePixelsAndNeverTouch) {
  for (const double density : {0.1, 0.4, 0.6, 0.9}) {
    Coverage coverage = Noise(50, 37, density, 11);
    // The corners of the image are not cut off.
    for (const std::size_t corner : {0u, 49u, 50u * 36, 50u * 37 - 1}) coverage.values[corner] = 0;
    const auto outlines = TraceOutlines(coverage);
    ASSERT_TRUE(outlines);
    double corners = 0;
    std::set<std::pair<double, double>> points;
    for (const Outline& outline : *outlines) {
      corners += SignedArea(outline) > 0 ? 0.5 : -0.5;
      for (const Complex p : outline) {
        EXPECT_TRUE(points.emplace(p.real(), p.imag()).second) << p;
      }
    }
    EXPECT_DOUBLE_EQ(AreaOf(*outlines), static_cast<double>(CountInside(coverage)) - corners);
    EXPECT_FALSE(AnyMeet(*outlines)) << density;
  }
}

TEST(TraceOutlines, SoftEdgesAreFollowedBetweenThePixels) {
  constexpr double kRadius = 20;
  const Complex middle(30.3, 29.6);
  const auto outlines =
      TraceOutlines(Drawn(61, 58, [&](Complex p) { return kRadius - std::abs(p - middle); }));
  ASSERT_TRUE(outlines);
  ASSERT_EQ(outlines->size(), 1u);
  // Steps between whole pixels would miss it by half a pixel.
  for (const Complex p : (*outlines)[0]) EXPECT_NEAR(std::abs(p - middle), kRadius, 0.1);
}

TEST(TraceOutlines, OfTooManyPointsAreRefused) {
  const auto outlines = TraceOutlines(Noise(1400, 1400, 0.5, 1));
  ASSERT_FALSE(outlines);
  EXPECT_EQ(outlines.error().kind, FaultKind::kLimitExceeded);
}

TEST(SimplifyOutlines, StayWithinTheToleranceAndApart) {
  Coverage noise = Noise(40, 40, 0.55, 5);
  const Coverage flower = Drawn(300, 300, [](Complex p) {
    const Complex q = p - Complex(150, 150);
    return 90 + 40 * std::cos(5 * std::arg(q)) - std::abs(q);
  });
  for (const Coverage& coverage : {noise, flower}) {
    const auto outlines = TraceOutlines(coverage);
    ASSERT_TRUE(outlines);
    std::size_t before = PointsOf(*outlines);
    for (const double tolerance : {0.4, 1.0, 3.0}) {
      const auto simple = SimplifyOutlines(*outlines, tolerance);
      ASSERT_TRUE(simple);
      ASSERT_EQ(simple->size(), outlines->size());
      for (std::size_t i = 0; i < simple->size(); ++i) {
        ASSERT_GE((*simple)[i].size(), 3u);
        EXPECT_LE(FurthestFrom((*outlines)[i], (*simple)[i]), tolerance * (1 + 1e-9));
        EXPECT_LE(FurthestFrom((*simple)[i], (*outlines)[i]), tolerance * (1 + 1e-9));
      }
      EXPECT_FALSE(AnyMeet(*simple)) << tolerance;
      EXPECT_LT(PointsOf(*simple), before);
      before = PointsOf(*simple);
      EXPECT_EQ(*simple, *SimplifyOutlines(*outlines, tolerance));
    }
  }
}

TEST(SimplifyOutlines, AStraightLineNeedsItsEndsOnly) {
  Outline square;
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < 100; ++i) {
      square.push_back(Complex(-50 + i, -50) * std::polar(1.0, side * std::numbers::pi / 2));
    }
  }
  const auto simple = SimplifyOutlines(std::vector<Outline>{square}, 0.5);
  ASSERT_TRUE(simple);
  EXPECT_EQ((*simple)[0].size(), 4u);
  EXPECT_NEAR(SignedArea((*simple)[0]), 10000, 1e-6);
}

}  // namespace
}  // namespace arap
