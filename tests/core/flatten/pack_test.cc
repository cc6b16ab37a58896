// Packed charts keep their distance, their shape and their handedness.
#include "core/flatten/sheet/pack.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/compare.h"
#include "tests/support/random.h"

namespace arap::testing {
namespace {

struct Charts {
  std::vector<Complex> uv;
  std::vector<std::uint32_t> chart;
  std::uint32_t count = 0;
};

// Charts of 3 to 40 points in ellipses of different size, place and direction; vertices of all
// charts are mixed, a few belong to none.
Charts RandomCharts(std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::pair<Complex, std::uint32_t>> points;
  for (std::uint32_t c = 0; c < count; ++c) {
    const double a = random.Uniform(0.1, 5), b = random.Uniform(0.1, 5);
    const double turn = random.Uniform(0, 7), x = random.Uniform(-9, 9);
    for (std::size_t k = 3 + random.Below(38); k > 0; --k) {
      const double u = random.Uniform(-a, a), v = random.Uniform(-b, b);
      points.emplace_back(std::polar(1.0, turn) * Complex(u, v) + x, c);
    }
  }
  points.emplace_back(Complex(1, 2), kNone);
  random.Shuffle(points);
  Charts charts;
  charts.count = count;
  for (const auto& [p, c] : points) charts.uv.push_back(p), charts.chart.push_back(c);
  return charts;
}

struct Bounds {
  double left = 1e300, right = -1e300, low = 1e300, high = -1e300;
};

std::vector<Bounds> BoundsOf(const Charts& charts) {
  std::vector<Bounds> bounds(charts.count);
  for (std::size_t v = 0; v < charts.uv.size(); ++v) {
    if (charts.chart[v] == kNone) continue;
    Bounds& b = bounds[charts.chart[v]];
    b.left = std::min(b.left, charts.uv[v].real());
    b.right = std::max(b.right, charts.uv[v].real());
    b.low = std::min(b.low, charts.uv[v].imag());
    b.high = std::max(b.high, charts.uv[v].imag());
  }
  return bounds;
}

// The least room between the boxes of two charts: the larger of that along x and along y.
double LeastRoom(const Charts& charts) {
  const std::vector<Bounds> bounds = BoundsOf(charts);
  double least = 1e300;
  for (std::size_t a = 0; a < bounds.size(); ++a) {
    for (std::size_t b = a + 1; b < bounds.size(); ++b) {
      const double x = std::max(bounds[a].left - bounds[b].right, bounds[b].left - bounds[a].right);
      const double y = std::max(bounds[a].low - bounds[b].high, bounds[b].low - bounds[a].high);
      least = std::min(least, std::max(x, y));
    }
  }
  return least;
}

double MeanSide(const Charts& charts) {
  double sum = 0;
  for (const Bounds& b : BoundsOf(charts)) sum += 0.5 * (b.right - b.left + b.high - b.low);
  return sum / charts.count;
}

TEST(PackTest, ChartsKeepTheirDistance) {
  for (const std::uint32_t count : {2u, 3u, 17u, 100u}) {
    for (const bool rotate : {false, true}) {
      for (const double gap : {0.0, 0.05, 1.0}) {
        Charts charts = RandomCharts(count, count);
        PackCharts(charts.uv, charts.chart, {gap, rotate});
        EXPECT_GE(LeastRoom(charts), gap * MeanSide(charts) - 1e-9) << count << ' ' << rotate;
      }
    }
  }
}

TEST(PackTest, TheOrderOfChartsDoesNotMatterForThat) {
  Random random(5);
  for (int round = 0; round < 10; ++round) {
    Charts charts = RandomCharts(12, 8);
    std::vector<std::uint32_t> names(12);
    for (std::uint32_t c = 0; c < 12; ++c) names[c] = c;
    random.Shuffle(names);
    for (std::uint32_t& c : charts.chart) c = c == kNone ? kNone : names[c];
    PackCharts(charts.uv, charts.chart);
    EXPECT_GE(LeastRoom(charts), 0.05 * MeanSide(charts) - 1e-9);
  }
}

TEST(PackTest, ShapesAndHandednessStay) {
  for (const bool rotate : {false, true}) {
    const Charts before = RandomCharts(15, 4);
    Charts after = before;
    const auto motions = PackCharts(after.uv, after.chart, {0.05, rotate});
    ASSERT_EQ(motions.size(), 15u);
    for (std::size_t v = 0; v < before.uv.size(); ++v) {
      if (before.chart[v] == kNone) {
        EXPECT_EQ(after.uv[v], before.uv[v]);
        continue;
      }
      const Motion& m = motions[before.chart[v]];
      EXPECT_LE(std::abs(m.rotation * before.uv[v] + m.shift - after.uv[v]), 1e-12);
      if (!rotate) {
        EXPECT_EQ(m.rotation, Complex(1));
      }
      for (std::size_t w = 0; w < v; ++w) {
        if (before.chart[w] != before.chart[v]) continue;
        const double length = std::abs(before.uv[v] - before.uv[w]);
        EXPECT_NEAR(std::abs(after.uv[v] - after.uv[w]) / length, 1, 1e-12 + 1e-14 / length);
      }
    }
    // A turn and a shift keep lengths; a mirror image would, too.
    for (const Motion& m : motions) EXPECT_NEAR(std::abs(m.rotation), 1, 1e-15);
  }
}

TEST(PackTest, ASingleChartStaysWhereItIs) {
  Charts charts = RandomCharts(1, 3);
  const std::vector<Complex> before = charts.uv;
  PackCharts(charts.uv, charts.chart);
  EXPECT_EQ(charts.uv, before);
  std::vector<Complex> none;
  EXPECT_TRUE(PackCharts(none, {}).empty());
}

TEST(PackTest, NumbersWithoutVerticesTakeNoRoom) {
  std::vector<Complex> uv{{5, 5}, {6, 6}, {0, 0}, {2, 3}};
  const std::vector<std::uint32_t> chart{1, 1, 4, 4};
  const auto motions = PackCharts(uv, chart, {0, false});
  EXPECT_EQ(motions.size(), 5u);
  EXPECT_EQ(motions[0].shift, Complex(0));
  // The higher one first, the other beside it.
  EXPECT_THAT(uv, ::testing::ElementsAre(Complex(2, 0), Complex(3, 1), Complex(0), Complex(2, 3)));
}

TEST(PackTest, TheSheetIsAboutSquare) {
  Charts charts = RandomCharts(200, 6);
  PackCharts(charts.uv, charts.chart);
  double width = 0, height = 0;
  for (const Bounds& b : BoundsOf(charts)) {
    EXPECT_GE(b.left, -1e-12);
    EXPECT_GE(b.low, -1e-12);
    width = std::max(width, b.right);
    height = std::max(height, b.high);
  }
  EXPECT_LT(width, 1.2 * height);
  EXPECT_LT(height, 1.2 * width);
}

TEST(PackTest, TheTurnFindsTheSmallestRectangle) {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    std::vector<Complex> points;
    for (std::size_t k = 3 + random.Below(round % 2 == 0 ? 60 : 300); k > 0; --k) {
      const double x = random.Uniform(-3, 3), y = random.Uniform(-1, 1);
      points.push_back(std::polar(1.0, 0.1 * round) * Complex(x, y));
    }
    const auto box = [&](Complex turn) {
      Bounds b;
      for (const Complex p : points) {
        b.left = std::min(b.left, (turn * p).real());
        b.right = std::max(b.right, (turn * p).real());
        b.low = std::min(b.low, (turn * p).imag());
        b.high = std::max(b.high, (turn * p).imag());
      }
      return Complex(b.right - b.left, b.high - b.low);
    };
    const Complex turn = UprightTurn(points);
    EXPECT_NEAR(std::abs(turn), 1, 1e-15);
    EXPECT_GE(turn.real(), -1e-15);
    const Complex found = box(turn);
    EXPECT_GE(found.real(), found.imag() * (1 - 1e-8));
    for (int k = 0; k < 1000; ++k) {
      const Complex other = box(std::polar(1.0, k * std::numbers::pi / 1000));
      EXPECT_LE(found.real() * found.imag(), other.real() * other.imag() * (1 + 1e-8));
    }
  }
}

// Points inside are left out before the hull is made: they change no bit.
TEST(PackTest, PointsInsideChangeNothing) {
  Random random(2);
  const std::vector<Complex> outline{{0, 0}, {4, 0}, {5, 2}, {3, 4}, {1, 4.5}, {-1, 2}};
  for (int round = 0; round < 50; ++round) {
    const Complex turn = std::polar(1.0, 0.1 * round);
    std::vector<Complex> points;
    for (const Complex p : outline) points.push_back(turn * p);
    const Complex alone = UprightTurn(points);
    for (int k = 0; k < 500; ++k) {
      points.push_back(turn * Complex(random.Uniform(0.2, 3.8), random.Uniform(0.2, 3)));
    }
    EXPECT_EQ(UprightTurn(points), alone) << round;
  }
}

TEST(PackTest, ARectangleLyingRightIsNotTurned) {
  const std::vector<Complex> lying{{0, 0}, {3, 0}, {3, 1}, {0, 1}};
  EXPECT_EQ(UprightTurn(lying), Complex(1));
  const std::vector<Complex> square{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}};
  EXPECT_EQ(UprightTurn(square), Complex(1));
  EXPECT_EQ(UprightTurn({{0, 0}, {1, 0}, {1, 3}, {0, 3}}), Complex(0, 1));
  EXPECT_EQ(UprightTurn({{1, 1}}), Complex(1));
  const Complex line = UprightTurn({{0, 0}, {1, -1}, {2, -2}, {2, -2}});
  EXPECT_NEAR(std::abs(line - std::polar(1.0, std::numbers::pi / 4)), 0, 1e-15);
}

}  // namespace
}  // namespace arap::testing
