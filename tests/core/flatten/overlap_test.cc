// Overlaps are found where they are, and none where boundaries only touch.
#include "core/flatten/sheet/overlap.h"

#include <cmath>
#include <map>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace arap::testing {
namespace {

constexpr double kPi = std::numbers::pi;

// Positions and boundary loops of several charts.
struct Layout {
  std::vector<Complex> uv;
  std::vector<BoundaryLoop> loops;

  // A chart of one outline, and holes (clockwise).
  void AddLoop(std::uint32_t chart, const std::vector<Complex>& points) {
    loops.push_back({chart, 0, {}});
    for (const Complex p : points) {
      loops.back().vertices.push_back(static_cast<std::uint32_t>(uv.size()));
      uv.push_back(p);
    }
  }

  // Follows the sides that only one triangle has.
  void AddMesh(std::uint32_t chart, const PlanarMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (const Triangle& t : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
    }
    std::map<std::uint32_t, std::uint32_t> next;
    for (const auto& [side, count] : sides) {
      if (!sides.contains({side.second, side.first})) next[side.first] = side.second;
    }
    const auto offset = static_cast<std::uint32_t>(uv.size());
    uv.insert(uv.end(), mesh.vertices.begin(), mesh.vertices.end());
    while (!next.empty()) {
      BoundaryLoop loop{chart, 0, {}};
      for (auto at = next.begin(); at != next.end(); at = next.find(loop.vertices.back())) {
        loop.vertices.push_back(at->second);
        next.erase(at);
      }
      for (std::uint32_t& v : loop.vertices) v += offset;
      loops.push_back(loop);
    }
  }

  Overlap Find() const { return *FindOverlap(uv, loops); }
};

std::vector<Complex> Rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

std::vector<Complex> Clockwise(std::vector<Complex> points) {
  return {points.rbegin(), points.rend()};
}

// A ribbon of unit width laid `turns` times around; its radius grows by `pitch` with every turn.
PlanarMesh Ribbon(std::size_t cells, double turns, double pitch) {
  PlanarMesh mesh = Grid(cells, 1, turns, 1);
  for (Complex& p : mesh.vertices) {
    const double radius = 5 - p.imag() + pitch * p.real();
    p = std::polar(radius, 2 * kPi * p.real());
  }
  return mesh;
}

TEST(OverlapTest, NoneInPlaneMeshes) {
  Layout layout;
  layout.AddMesh(0, JitteredGrid(9, 7, 4));
  EXPECT_FALSE(layout.Find().any());
  Layout ring;
  ring.AddMesh(0, Annulus(3, 20, 1, 2));
  EXPECT_EQ(ring.loops.size(), 2u);
  EXPECT_FALSE(ring.Find().any());
  EXPECT_FALSE(FindOverlap({}, {})->any());
}

TEST(OverlapTest, NamesTheSegmentsThatCross) {
  Layout layout;
  layout.AddLoop(0, {{0, 0}, {4, 0}, {4, 3}, {1, -1}, {0, 3}});
  const Overlap overlap = layout.Find();
  EXPECT_EQ(overlap.crossings, 2u);
  EXPECT_THAT(overlap.first_crossing, ::testing::ElementsAre(0u, 1u, 2u, 3u));
}

TEST(OverlapTest, SpiralsOverlapWhenTheirTurnsDo) {
  for (const std::size_t cells : {60u, 700u}) {
    for (const double pitch : {-1.2, -0.8, -0.1, 0.0, 0.1, 0.8, 1.2}) {
      Layout layout;
      layout.AddMesh(0, Ribbon(cells, 2.3, pitch));
      EXPECT_EQ(layout.Find().any(), std::abs(pitch) < 1) << cells << ' ' << pitch;
    }
  }
  Layout once;
  once.AddMesh(0, Ribbon(60, 0.95, 0));
  EXPECT_FALSE(once.Find().any());
  Layout twice;  // the second turn exactly on the first
  twice.AddMesh(0, Ribbon(60, 2, 0));
  EXPECT_TRUE(twice.Find().any());
}

// Unit cells on unit cells: wherever the squares meet, corners lie on corners or on sides.
TEST(OverlapTest, TouchingIsNotOverlapping) {
  for (const double angle : {0.0, 0.3, kPi / 4}) {
    for (int x = -3; x <= 3; ++x) {
      for (int y = -3; y <= 3; ++y) {
        Layout layout;
        layout.AddMesh(0, Grid(2, 2, 2, 2));
        layout.AddMesh(1, Moved(Grid(2, 2, 2, 2), 1, Complex(x, y)));
        for (Complex& p : layout.uv) p *= std::polar(1.0, angle);
        const bool apart = std::abs(x) >= 2 || std::abs(y) >= 2;
        EXPECT_EQ(layout.Find().any(), !apart) << x << ' ' << y << ' ' << angle;
      }
    }
  }
}

// A slit from the middle of one side into a square, its two sides on one another up to rounding.
TEST(OverlapTest, TheSidesOfACutMayLieOnOneAnother) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    Layout layout;
    std::vector<Complex> outline{{0, 0}, {10, 0}, {10, 5}};
    for (int k = 9; k > 4; --k) outline.emplace_back(k, 5);
    for (int k = 5; k < 10; ++k) outline.emplace_back(k, 5);
    outline.insert(outline.end(), {{10, 5}, {10, 10}, {0, 10}});
    for (Complex& p : outline) {
      const double x = random.Uniform(-1, 1), y = random.Uniform(-1, 1);
      p += 1e-9 * Complex(x, y);
    }
    layout.AddLoop(0, outline);
    EXPECT_FALSE(layout.Find().any());
    for (std::size_t k = 9; k < 14; ++k) layout.uv[k] -= Complex(0, 0.01);
    EXPECT_TRUE(layout.Find().any());  // now the upper part reaches into the lower
  }
}

TEST(OverlapTest, AChartInsideAnotherIsFound) {
  Layout inside;
  inside.AddLoop(0, Rectangle(4, 4, 1, 1));
  inside.AddLoop(7, Rectangle(0, 0, 10, 10));
  EXPECT_EQ(inside.Find().crossings, 0u);
  EXPECT_EQ(inside.Find().misplaced_loops, 1u);
  EXPECT_EQ(inside.Find().first_misplaced, 0u);
  Layout in_hole = inside;
  in_hole.AddLoop(7, Clockwise(Rectangle(3, 3, 3, 3)));
  EXPECT_FALSE(in_hole.Find().any());
  Layout same;
  same.AddLoop(0, Rectangle(0, 0, 10, 10));
  same.AddLoop(1, Rectangle(0, 0, 10, 10));
  EXPECT_TRUE(same.Find().any());
}

TEST(OverlapTest, RingsOverlapWithoutTheirOutlinesCrossing) {
  Layout rings;
  rings.AddMesh(0, Annulus(2, 32, 1, 3));
  rings.AddMesh(1, Annulus(2, 32, 2, 4));
  EXPECT_EQ(rings.Find().crossings, 0u);
  EXPECT_EQ(rings.Find().misplaced_loops, 2u);
  Layout nested;
  nested.AddMesh(0, Annulus(2, 32, 1, 2));
  nested.AddMesh(1, Annulus(2, 32, 2.1, 4));
  EXPECT_FALSE(nested.Find().any());
}

TEST(OverlapTest, AHoleOutsideItsChartIsMisplaced) {
  Layout layout;
  layout.AddLoop(0, Rectangle(0, 0, 1, 1));
  layout.AddLoop(0, Clockwise(Rectangle(2, 0, 1, 1)));
  EXPECT_EQ(layout.Find().misplaced_loops, 1u);
  EXPECT_EQ(layout.Find().first_misplaced, 1u);
  Layout inside_out;
  inside_out.AddLoop(0, Rectangle(0, 0, 10, 10));
  inside_out.AddLoop(0, Rectangle(4, 4, 1, 1));
  EXPECT_EQ(inside_out.Find().misplaced_loops, 1u);
  EXPECT_EQ(inside_out.Find().first_misplaced, 1u);
}

double Turn(Complex a, Complex b, Complex c) { return std::imag(std::conj(b - a) * (c - a)); }

// Every pair, without any of the care for touching.
std::size_t CrossingsOfAllPairs(const std::vector<Complex>& p) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = i + 2; j < p.size(); ++j) {
      const std::size_t k = (j + 1) % p.size();
      if (k == i) continue;
      const Complex a = p[i], b = p[i + 1], c = p[j], d = p[k];
      if (Turn(a, b, c) * Turn(a, b, d) < 0 && Turn(c, d, a) * Turn(c, d, b) < 0) ++count;
    }
  }
  return count;
}

TEST(OverlapTest, CountsAsComparingAllPairsDoes) {
  Random random(11);
  for (const std::size_t n : {5u, 20u, 150u}) {
    std::vector<Complex> points;
    while (points.size() < n) {
      const double x = random.Uniform(0, 1), y = random.Uniform(0, 1);
      points.emplace_back(x, y);
    }
    Layout layout;
    layout.AddLoop(0, points);
    EXPECT_EQ(layout.Find().crossings, CrossingsOfAllPairs(points)) << n;
  }
}

// How often a closed line goes round a point, every segment looked at.
int WindingOfAllSegments(const std::vector<Complex>& line, Complex p) {
  int winding = 0;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const Complex from = line[k], to = line[(k + 1) % line.size()];
    const bool up = from.imag() <= p.imag(), down = to.imag() <= p.imag();
    if (up && !down && Turn(from, to, p) > 0) ++winding;
    if (!up && down && Turn(from, to, p) < 0) --winding;
  }
  return winding;
}

TEST(OverlapTest, FindsWhatIsInsideAsLookingAtAllSegmentsDoes) {
  Random random(5);
  std::vector<Complex> comb{{0, 0}, {101, 0}};
  for (int tooth = 100; tooth >= 0; --tooth) {
    comb.insert(comb.end(), {{tooth + 0.6, 5}, {tooth + 0.3, random.Uniform(0.5, 4)}});
  }
  std::vector<Complex> star;
  for (int k = 0; k < 3000; ++k) {
    star.push_back(std::polar(random.Uniform(1, 5), 2 * kPi / 3000 * k) + Complex(50, 2));
  }
  for (const auto& outline : {comb, star}) {
    Layout layout;
    layout.AddLoop(0, outline);
    std::size_t inside = 0;
    for (std::uint32_t chart = 1; chart <= 400; ++chart) {
      const Complex at(random.Uniform(40, 60), random.Uniform(-3, 7));
      layout.AddLoop(chart, Rectangle(at.real(), at.imag(), 1e-4, 1e-4));
      if (WindingOfAllSegments(outline, at) != 0) ++inside;
    }
    EXPECT_GT(inside, 50u);
    EXPECT_LT(inside, 350u);
    EXPECT_EQ(layout.Find().misplaced_loops, inside);
  }
}

// The caller is asked once in a fixed number of comparisons, so that its answers count the work.
TEST(OverlapTest, ManyChartsSideBySideAreNotComparedWithEachOther) {
  Layout layout;
  for (std::uint32_t chart = 0; chart < 40'000; ++chart) {
    layout.AddLoop(chart, Rectangle(2 * (chart % 200), 2 * (chart / 200), 1, 1));
  }
  std::size_t asked = 0;
  const auto overlap = FindOverlap(layout.uv, layout.loops, CancelToken([&asked]() -> Status {
                                     ++asked;
                                     return {};
                                   }));
  ASSERT_TRUE(overlap);
  EXPECT_FALSE(overlap->any());
  EXPECT_GT(asked, 0u);
  EXPECT_LT(asked, 100u);
}

TEST(OverlapTest, StopsWhenTheCallerGivesUp) {
  Layout layout;
  for (std::uint32_t chart = 0; chart < 20'000; ++chart) {
    layout.AddLoop(chart, Rectangle(2 * chart, 0, 1, 1));
  }
  const auto overlap = FindOverlap(layout.uv, layout.loops, CancelToken([]() -> Status {
                                     return Fail(FaultKind::kCancelled, "The caller gave up.");
                                   }));
  ASSERT_FALSE(overlap);
  EXPECT_EQ(overlap.error().kind, FaultKind::kCancelled);
}

TEST(OverlapTest, StopsCountingAtItsLimit) {
  Random random(12);
  std::vector<Complex> points;
  while (points.size() < 2000) {
    const double x = random.Uniform(0, 1), y = random.Uniform(0, 1);
    points.emplace_back(x, y);
  }
  Layout layout;
  layout.AddLoop(0, points);
  EXPECT_EQ(layout.Find().crossings, kMaxCrossings);
}

TEST(OverlapTest, TakesAHundredThousandSegments) {
  for (const double pitch : {1.01, 0.99}) {
    Layout layout;
    layout.AddMesh(0, Ribbon(50'000, 40, pitch));
    const Overlap overlap = layout.Find();
    EXPECT_EQ(overlap.any(), pitch < 1);
    EXPECT_EQ(overlap.misplaced_loops, 0u);
  }
}

TEST(OverlapTest, TakesAHundredThousandSpikes) {
  Random random(2);
  std::vector<Complex> star;
  for (int k = 0; k < 100'000; ++k) {
    star.push_back(std::polar(random.Uniform(1, 1.01), 2e-5 * kPi * k));
  }
  Layout layout;
  layout.AddLoop(0, star);
  EXPECT_FALSE(layout.Find().any());
}

}  // namespace
}  // namespace arap::testing
