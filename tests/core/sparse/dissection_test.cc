// Orders by halving: what is left between the cuts, what they save, and patterns that have no cut.
#include "core/sparse/dissection.h"

#include <algorithm>
#include <complex>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>
#include <gtest/gtest.h>

#include "core/sparse/elimination_order.h"
#include "core/sparse/factor.h"

namespace arap::testing {
namespace {

using Point = std::complex<double>;
using Matrix = Eigen::SparseMatrix<double>;

// A definite matrix of so many unknowns with a −1 for each of these pairs.
Matrix WithEdges(int size, const std::vector<std::pair<int, int>>& edges) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& [a, b] : edges) {
    entries.emplace_back(std::max(a, b), std::min(a, b), -1);
    entries.emplace_back(a, a, 1);
    entries.emplace_back(b, b, 1);
  }
  for (int v = 0; v < size; ++v) entries.emplace_back(v, v, 1);
  Matrix lower(size, size);
  lower.setFromTriplets(entries.begin(), entries.end());
  return lower;
}

// A square of side·side unknowns, each beside the eight around it.
struct Square {
  explicit Square(int side) {
    std::vector<std::pair<int, int>> edges;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        points.emplace_back(x, y);
        const int v = y * side + x;
        if (x + 1 < side) edges.emplace_back(v, v + 1);
        if (y + 1 < side) edges.emplace_back(v, v + side);
        if (x + 1 < side && y + 1 < side) edges.emplace_back(v, v + side + 1);
        if (x > 0 && y + 1 < side) edges.emplace_back(v, v + side - 1);
      }
    }
    lower = WithEdges(side * side, edges);
  }
  std::vector<Point> points;
  Matrix lower;
};

std::vector<int> StagesOf(const Matrix& lower, const std::vector<Point>& points) {
  const auto n = static_cast<std::size_t>(lower.rows());
  return DissectionStages({{lower.outerIndexPtr(), n + 1},
                           {lower.innerIndexPtr(), static_cast<std::size_t>(lower.nonZeros())}},
                          points);
}

// The sizes of what hangs together in stages up to `last`, the largest first.
std::vector<int> PartsOf(const Matrix& lower, const std::vector<int>& stages, int last) {
  std::vector<int> root(stages.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int v) {
    while (root[static_cast<std::size_t>(v)] != v) v = root[static_cast<std::size_t>(v)];
    return v;
  };
  const auto is_in = [&](Eigen::Index v) { return stages[static_cast<std::size_t>(v)] <= last; };
  for (Eigen::Index c = 0; c < lower.cols(); ++c) {
    for (Matrix::InnerIterator it(lower, c); it; ++it) {
      if (!is_in(it.row()) || !is_in(c)) continue;
      const int a = find(static_cast<int>(it.row())), b = find(static_cast<int>(c));
      root[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
  }
  std::vector<int> sizes(stages.size(), 0);
  for (std::size_t v = 0; v < stages.size(); ++v) {
    if (stages[v] <= last) ++sizes[static_cast<std::size_t>(find(static_cast<int>(v)))];
  }
  std::erase(sizes, 0);
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

TEST(DissectionTest, HalvesASquareAgainAndAgain) {
  const Square square(100);
  const auto stages = StagesOf(square.lower, square.points);
  // 10,000 in three rounds: parts of at most 2000.
  EXPECT_EQ(*std::max_element(stages.begin(), stages.end()), 3);
  EXPECT_EQ(std::count(stages.begin(), stages.end(), 3), 100);  // a column
  const auto halves = PartsOf(square.lower, stages, 2);
  ASSERT_EQ(halves.size(), 2u);
  EXPECT_GE(halves[1], 4900);
  const auto parts = PartsOf(square.lower, stages, 0);
  EXPECT_EQ(parts.size(), 8u);
  EXPECT_LE(parts[0], 2000);
  EXPECT_GE(parts[7], 1000);
  EXPECT_EQ(StagesOf(square.lower, square.points), stages);
}

TEST(DissectionTest, LeavesLessFillThanMinimumDegreeAndSolvesAlike) {
  const Square square(170);
  const auto by_degree = EliminationOrder(square.lower);
  const auto by_halves = EliminationOrder(square.lower, square.points);
  ASSERT_TRUE(by_degree.has_value() && by_halves.has_value());
  auto sorted = *by_halves;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t k = 0; k < sorted.size(); ++k) ASSERT_EQ(sorted[k], static_cast<int>(k));
  const auto one = Factor<double>::Make(square.lower, FactorLayout::kPacked, *by_degree);
  const auto two = Factor<double>::Make(square.lower, FactorLayout::kPacked, *by_halves);
  ASSERT_TRUE(one.has_value() && two.has_value());
  EXPECT_LT((*two)->bytes(), (*one)->bytes());
  std::vector<double> right(square.points.size());
  for (std::size_t v = 0; v < right.size(); ++v) right[v] = static_cast<double>(v % 7);
  Workspace first, second;
  const auto x = *(*one)->Solve(right, 1, first), y = *(*two)->Solve(right, 1, second);
  for (std::size_t v = 0; v < right.size(); ++v) ASSERT_NEAR(x[v], y[v], 1e-11);
}

TEST(DissectionTest, PointsInOnePlaceAreHalvedByNumber) {
  // A path: any order of its points is cut in a few vertices only if it is that of their numbers.
  constexpr int kSize = 5000;
  std::vector<std::pair<int, int>> edges;
  for (int v = 0; v + 1 < kSize; ++v) edges.emplace_back(v, v + 1);
  const auto stages = StagesOf(WithEdges(kSize, edges), std::vector<Point>(kSize, Point(3, -1)));
  EXPECT_EQ(std::count_if(stages.begin(), stages.end(), [](int s) { return s > 0; }), 3);
}

TEST(DissectionTest, WhatNoShortCutHalvesIsLeftToMinimumDegree) {
  constexpr int kSize = 6000;
  // Neighbours in number that are far apart in space.
  std::vector<std::pair<int, int>> edges;
  std::vector<Point> points;
  for (int v = 0; v < kSize; ++v) {
    points.emplace_back(v % 2 == 0 ? 0 : 1e6, v);
    if (v + 1 < kSize) edges.emplace_back(v, v + 1);
  }
  const auto stages = StagesOf(WithEdges(kSize, edges), points);
  EXPECT_EQ(*std::max_element(stages.begin(), stages.end()), 0);
}

TEST(DissectionTest, PartsThatNothingJoinsNeedNoCut) {
  const Square one(60);
  auto points = one.points;
  for (const Point p : one.points) points.push_back(p + Point(100, 0));
  std::vector<std::pair<int, int>> edges;
  const int n = static_cast<int>(one.points.size());
  for (Eigen::Index c = 0; c < one.lower.cols(); ++c) {
    for (Matrix::InnerIterator it(one.lower, c); it; ++it) {
      if (it.row() == c) continue;
      const int a = static_cast<int>(it.row()), b = static_cast<int>(c);
      edges.emplace_back(a, b);
      edges.emplace_back(a + n, b + n);
    }
  }
  const auto stages = StagesOf(WithEdges(2 * n, edges), points);
  // Each is cut once, in its middle.
  EXPECT_EQ(std::count_if(stages.begin(), stages.end(), [](int s) { return s > 0; }), 2 * 60);
}

TEST(DissectionTest, NothingAndAlmostNothing) {
  EXPECT_TRUE(StagesOf(Matrix(0, 0), {}).empty());
  EXPECT_EQ(StagesOf(WithEdges(1, {}), {Point(1, 1)}), std::vector<int>{0});
}

}  // namespace
}  // namespace arap::testing
