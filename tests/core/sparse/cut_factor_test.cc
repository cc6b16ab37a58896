// A factor that is cut into parts: it solves the same, with the same bytes whoever takes the parts.
#include <algorithm>
#include <complex>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/sparse/packed_factor.h"
#include "tests/core/sparse/random.h"
#include "tests/support/thread_crew.h"

namespace arap::testing {
namespace {

// How the unknowns of a grid are eliminated.
enum class Numbering { kDissected, kByRow, kShuffled };

// Halves before the line between them, so that subtrees are numbered one after the other.
void Dissect(int x0, int x1, int y0, int y1, int side, std::vector<int>& order) {
  if (x1 - x0 < y1 - y0) {
    const int middle = (y0 + y1) / 2;
    if (y1 - y0 > 2) Dissect(x0, x1, y0, middle, side, order);
    if (y1 - y0 > 2) Dissect(x0, x1, middle + 1, y1, side, order);
    const bool whole = y1 - y0 <= 2;
    for (int y = whole ? y0 : middle; y < (whole ? y1 : middle + 1); ++y) {
      for (int x = x0; x < x1; ++x) order.push_back(y * side + x);
    }
    return;
  }
  const int middle = (x0 + x1) / 2;
  if (x1 - x0 > 2) Dissect(x0, middle, y0, y1, side, order);
  if (x1 - x0 > 2) Dissect(middle + 1, x1, y0, y1, side, order);
  const bool whole = x1 - x0 <= 2;
  for (int x = whole ? x0 : middle; x < (whole ? x1 : middle + 1); ++x) {
    for (int y = y0; y < y1; ++y) order.push_back(y * side + x);
  }
}

// A grid of side² unknowns, factored column by column; every column is a supernode.
template <class Scalar>
struct GridFactor {
  using Dense = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  Dense matrix;
  std::vector<int> first{0}, rows_begin{0}, rows, values_begin{0}, order;
  std::vector<Scalar> values;

  GridFactor(int side, Numbering numbering) {
    std::mt19937_64 random(9);
    const int n = side * side;
    Dissect(0, side, 0, side, side, order);
    if (numbering == Numbering::kByRow) std::sort(order.begin(), order.end());
    if (numbering == Numbering::kShuffled) std::shuffle(order.begin(), order.end(), random);
    matrix = Dense::Identity(n, n) * Scalar(9);
    for (int v = 0; v < n; ++v) {
      for (const int next : {v + 1, v + side}) {
        if (next >= n || (next == v + 1 && next % side == 0)) continue;
        matrix(next, v) = Number<Scalar>(random);
        matrix(v, next) = Eigen::numext::conj(matrix(next, v));
      }
    }
    Dense permuted(n, n);
    for (int r = 0; r < n; ++r) {
      for (int c = 0; c < n; ++c) permuted(r, c) = matrix(At(r), At(c));
    }
    const Dense l = permuted.llt().matrixL();
    for (int c = 0; c < n; ++c) {
      for (int r = c; r < n; ++r) {
        if (l(r, c) == Scalar(0)) continue;
        rows.push_back(r);
        values.push_back(l(r, c));
      }
      first.push_back(c + 1);
      rows_begin.push_back(static_cast<int>(rows.size()));
      values_begin.push_back(static_cast<int>(values.size()));
    }
  }
  int At(int k) const { return order[static_cast<std::size_t>(k)]; }
  PackedFactor<Scalar> Pack(std::size_t part_numbers) const {
    const SupernodalPattern pattern{first, rows_begin, rows, values_begin, order};
    PackedFactor<Scalar> packed(pattern, part_numbers);
    for (std::size_t s = 0; s + 1 < first.size(); ++s) {
      std::copy(values.begin() + values_begin[s], values.begin() + values_begin[s + 1],
                packed.blocks() + packed.block_begin()[s]);
    }
    packed.Pack(pattern);
    return packed;
  }
};

template <class Scalar>
std::vector<Scalar> Solve(const PackedFactor<Scalar>& factor, const std::vector<Scalar>& right,
                          Crew* crew, const PackedKernels& kernels = SolveKernels()) {
  std::vector<Scalar> x(right.size());
  std::vector<double> scratch(factor.ScratchSize(), 7.0);
  factor.Solve(right.data(), right.size() / factor.size(), x.data(), scratch, crew, kernels);
  return x;
}

template <class Scalar>
bool SameBytes(const std::vector<Scalar>& a, const std::vector<Scalar>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Scalar)) == 0;
}

template <class Scalar>
class CutFactorTest : public ::testing::Test {};
using CutScalars = ::testing::Types<double, std::complex<double>>;
TYPED_TEST_SUITE(CutFactorTest, CutScalars);

TYPED_TEST(CutFactorTest, SolvesLikeADenseMatrixWithTheSameBytesForEveryCrew) {
  using Scalar = TypeParam;
  std::mt19937_64 random(4);
  for (const Numbering numbering :
       {Numbering::kDissected, Numbering::kByRow, Numbering::kShuffled}) {
    const GridFactor<Scalar> grid(17, numbering);
    const auto n = static_cast<std::size_t>(grid.matrix.rows());
    for (const std::size_t part_numbers : {50u, 400u}) {
      SCOPED_TRACE(std::to_string(static_cast<int>(numbering)) + ", " +
                   std::to_string(part_numbers) + " numbers");
      const PackedFactor<Scalar> cut = grid.Pack(part_numbers);
      // By row it is one chain of columns; of a shuffled one nothing is promised.
      if (numbering == Numbering::kDissected) {
        EXPECT_GT(cut.parts(), 2u);
      } else if (numbering == Numbering::kByRow) {
        EXPECT_LE(cut.parts(), 1u);
      }
      for (std::size_t columns = 1; columns <= 5; ++columns) {
        std::vector<Scalar> right(n * columns);
        for (Scalar& x : right) x = Number<Scalar>(random);
        // One that has few numbers.
        std::fill_n(right.begin(), n, Scalar(0));
        right[n / 3] = Scalar(1);
        const Eigen::Map<const typename GridFactor<Scalar>::Dense> b(
            right.data(), static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(columns));
        const typename GridFactor<Scalar>::Dense expected = grid.matrix.llt().solve(b);
        const std::vector<Scalar> alone = Solve<Scalar>(cut, right, nullptr);
        for (std::size_t i = 0; i < right.size(); ++i) {
          ASSERT_LE(std::abs(alone[i] - expected.data()[i]), 1e-12);
        }
        for (const std::size_t threads : {1u, 2u, 3u, 7u}) {
          ThreadCrew crew(threads);
          EXPECT_TRUE(SameBytes(alone, Solve<Scalar>(cut, right, &crew))) << threads;
        }
        for (const PackedKernels& kernels : SolveKernelsHere()) {
          EXPECT_TRUE(SameBytes(alone, Solve<Scalar>(cut, right, nullptr, kernels)));
        }
        const std::vector<Scalar> last(right.end() - static_cast<std::ptrdiff_t>(n), right.end());
        const std::vector<Scalar> last_alone = Solve<Scalar>(cut, last, nullptr);
        EXPECT_EQ(std::memcmp(last_alone.data(), &alone[n * (columns - 1)], n * sizeof(Scalar)), 0)
            << "a column's bytes do not depend on its neighbours";
      }
    }
  }
}

TEST(CutFactorPointsTest, GivesTheBytesOfTwoColumns) {
  const GridFactor<double> grid(17, Numbering::kDissected);
  const PackedFactor<double> cut = grid.Pack(100);
  const std::size_t n = cut.size();
  std::mt19937_64 random(5);
  std::vector<std::complex<double>> points(3 * n), together(3 * n);
  for (auto& point : points) point = Number<std::complex<double>>(random);
  std::vector<double> scratch(cut.ScratchSize());
  ThreadCrew crew(3);
  const PointSolve pair[] = {{points.data(), together.data()},
                             {points.data() + n, together.data() + n}};
  cut.SolvePoints(pair, scratch, &crew);
  const PointSolve last[] = {{points.data() + 2 * n, together.data() + 2 * n}};
  cut.SolvePoints(last, scratch, &crew);
  for (std::size_t shape = 0; shape < 3; ++shape) {
    std::vector<double> columns(2 * n);
    for (std::size_t v = 0; v < n; ++v) {
      columns[v] = points[shape * n + v].real();
      columns[n + v] = points[shape * n + v].imag();
    }
    const std::vector<double> both = Solve<double>(cut, columns, nullptr);
    for (std::size_t v = 0; v < n; ++v) {
      ASSERT_EQ(together[shape * n + v], std::complex<double>(both[v], both[n + v]));
    }
  }
}

TEST(CutFactorPointsTest, ASmallFactorIsNotCut) {
  EXPECT_EQ(GridFactor<double>(17, Numbering::kDissected).Pack(std::size_t{1} << 20u).parts(), 0u);
}

}  // namespace
}  // namespace arap::testing
