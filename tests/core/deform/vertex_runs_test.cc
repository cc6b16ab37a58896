#include "core/deform/vertex_runs.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/mesh/topology.h"

namespace arap {
namespace {

// Numbers without a pattern, some negative.
std::vector<Complex> Points(std::size_t n) {
  std::vector<Complex> points;
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<double>(i);
    points.emplace_back(std::sin(1 + 3 * k), 2 * std::cos(5 * k));
  }
  return points;
}

std::vector<Complex> Shape(std::size_t n) {
  std::vector<Complex> shape;
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<double>(i);
    shape.emplace_back(std::cos(7 * k), std::sin(11 * k));
  }
  return shape;
}

TEST(VertexRuns, AreNeighboursOfOneComponent) {
  const std::vector<std::uint32_t> component{0, 0, 1, kNone, kNone, 0};
  const auto runs = RunsOf(component);
  ASSERT_EQ(runs.size(), 4u);
  EXPECT_EQ(runs[0].end, 2u);
  EXPECT_EQ(runs[1].component, 1u);
  EXPECT_EQ(runs[2].component, kNone);
  EXPECT_EQ(runs[2].begin, 3u);
  EXPECT_EQ(runs[3].begin, 5u);
  EXPECT_EQ(runs[3].end, 6u);
  EXPECT_TRUE(RunsOf({}).empty());
}

// Runs of every length that several vertices at a time leave a rest of: each number is that of the
// formula, to the last bit, and what is outside the run stays.
TEST(VertexRuns, MoveWhatIsInTheRunAndNothingElse) {
  const Similarity s{{0.3, -2}, {5, 0.25}, {0.6, -1.7}};
  for (std::uint32_t length = 0; length <= 19; ++length) {
    const VertexRun run{2, 2 + length, 0};
    const std::size_t n = length + 5;
    const std::vector<Complex> rest = Points(n);
    const std::vector<Complex> before = Shape(n);
    std::vector<Complex> set = before, added = before, shifted = before;
    SetToSimilarity(run, rest, s, set);
    AddSimilarityOf(run, rest, s, added);
    Shift(run, {0.1, -0.7}, shifted);
    for (std::size_t v = 0; v < n; ++v) {
      const bool inside = v >= run.begin && v < run.end;
      const Complex arm = rest[v] - s.from;
      const double px = s.place.real() + (s.turn.real() * arm.real() - s.turn.imag() * arm.imag());
      const double py = s.place.imag() + (s.turn.real() * arm.imag() + s.turn.imag() * arm.real());
      const Complex p(px, py);
      EXPECT_EQ(set[v], inside ? p : before[v]) << length << " " << v;
      EXPECT_EQ(added[v], inside ? before[v] + p : before[v]);
      EXPECT_EQ(shifted[v], inside ? before[v] + Complex(0.1, -0.7) : before[v]);
    }
  }
}

TEST(VertexRuns, AddAWholeShape) {
  for (std::size_t n = 0; n <= 9; ++n) {
    const std::vector<Complex> before = Shape(n), added(n, {0.1, -0.3});
    std::vector<Complex> sum = before;
    AddShape(added, sum);
    for (std::size_t v = 0; v < n; ++v) EXPECT_EQ(sum[v], before[v] + Complex(0.1, -0.3));
  }
}

TEST(VertexRuns, GoBackToTheUnitsOfTheMesh) {
  const std::size_t n = 11;
  const std::vector<Complex> shape = Shape(n);
  const VertexRun run{1, 10, 0};
  std::vector<Complex> positions(n, Complex(-1, -1));
  EXPECT_TRUE(ToUnits(run, shape, {0.5, 2}, 100, {1e6, -3}, positions));
  for (std::size_t v = 0; v < n; ++v) {
    const bool inside = v >= run.begin && v < run.end;
    EXPECT_EQ(positions[v].real(), inside ? 1e6 + 100 * (shape[v].real() + 0.5) : -1);
    EXPECT_EQ(positions[v].imag(), inside ? -3 + 100 * (shape[v].imag() + 2) : -1);
  }
}

TEST(VertexRuns, SayWhereverANumberIsNotFinite) {
  const std::size_t n = 11;
  std::vector<Complex> positions(n);
  for (const double strange :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e308}) {
    for (std::uint32_t at = 0; at < n; ++at) {
      for (const bool in_x : {true, false}) {
        std::vector<Complex> shape = Shape(n);
        // 1e308 overflows in the units of the mesh.
        shape[at] = in_x ? Complex(strange, 0) : Complex(0, strange);
        EXPECT_FALSE(ToUnits({0, n, 0}, shape, 0, 100, 0, positions)) << strange << " " << at;
        // A run that it is not in.
        EXPECT_TRUE(at == 0 || ToUnits({0, at, 0}, shape, 0, 100, 0, positions));
      }
    }
  }
}

}  // namespace
}  // namespace arap
