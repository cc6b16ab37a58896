// The packed factor against CHOLMOD's own solves and dense Eigen, and its promises about bytes.
#include <algorithm>
#include <complex>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/sparse/factor.h"
#include "core/sparse/packed_factor.h"
#include "tests/core/sparse/random.h"

namespace arap::testing {
namespace {

template <class Scalar>
using Dense = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

template <class Scalar>
std::vector<Scalar> Numbers(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Scalar> numbers(count);
  for (Scalar& x : numbers) x = Number<Scalar>(random);
  return numbers;
}

// The lower triangle of a diagonally dominant Hermitian matrix with the pattern of `blocks` grids
// of side² vertices that do not touch.
template <class Scalar>
Eigen::SparseMatrix<Scalar> Grids(int side, int blocks, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const int n = side * side * blocks;
  std::vector<Eigen::Triplet<Scalar, int>> triplets;
  std::vector<double> diagonal(static_cast<std::size_t>(n), 0.1);
  const auto join = [&](int i, int j) {
    const Scalar x = Number<Scalar>(random);
    triplets.emplace_back(std::max(i, j), std::min(i, j), x);
    diagonal[static_cast<std::size_t>(i)] += std::abs(x);
    diagonal[static_cast<std::size_t>(j)] += std::abs(x);
  };
  for (int v = 0; v < n; ++v) {
    const int column = v % side, row = v / side % side;
    if (column + 1 < side) join(v, v + 1);
    if (row + 1 < side) join(v, v + side);
    if (column + 1 < side && row + 1 < side) join(v, v + side + 1);
  }
  for (int v = 0; v < n; ++v) {
    triplets.emplace_back(v, v, Scalar(diagonal[static_cast<std::size_t>(v)]));
  }
  Eigen::SparseMatrix<Scalar> lower(n, n);
  lower.setFromTriplets(triplets.begin(), triplets.end());
  return lower;
}

// The widest factors made by hand: panels of every width.
constexpr int kWidest = 20;

// A factor without zeros, by hand: one supernode, cut into panels.
template <class Scalar>
struct HandMade {
  int size;
  std::vector<int> first{0, size}, rows_begin{0, size}, rows, values_begin{0, size*size}, order;
  Dense<Scalar> l = Dense<Scalar>::Zero(size, size);

  explicit HandMade(int columns) : size(columns) {
    std::mt19937_64 random(3);
    for (int c = 0; c < size; ++c) {
      rows.push_back(c);
      order.push_back((c + 2) % size);
      l(c, c) = Scalar(2 + c % 3);
      for (int r = c + 1; r < size; ++r) l(r, c) = 0.3 * Number<Scalar>(random);
    }
  }
  PackedFactor<Scalar> Pack() const {
    const SupernodalPattern pattern{first, rows_begin, rows, values_begin, order};
    PackedFactor<Scalar> packed(pattern);
    std::copy_n(l.data(), size * size, packed.blocks() + packed.block_begin()[0]);
    packed.Pack(pattern);
    return packed;
  }
};

template <class Scalar>
double Worst(std::span<const Scalar> a, std::span<const Scalar> b) {
  EXPECT_EQ(a.size(), b.size());
  double worst = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    worst = std::max(worst, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(b[i]));
  }
  return worst / size;
}

template <class Scalar>
std::vector<Scalar> Solve(const PackedFactor<Scalar>& factor, const std::vector<Scalar>& right,
                          std::size_t columns, const PackedKernels& kernels) {
  std::vector<Scalar> x(right.size());
  std::vector<double> scratch(factor.ScratchSize());
  factor.Solve(right.data(), columns, x.data(), scratch, nullptr, kernels);
  return x;
}

template <class Scalar>
bool SameBytes(std::span<const Scalar> a, std::span<const Scalar> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

template <class Scalar>
class PackedSolveTest : public ::testing::Test {};
using Scalars = ::testing::Types<double, std::complex<double>>;
TYPED_TEST_SUITE(PackedSolveTest, Scalars);

TYPED_TEST(PackedSolveTest, SolvesLikeADenseMatrix) {
  using Scalar = TypeParam;
  for (int size = 1; size <= kWidest; ++size) {
    const HandMade<Scalar> made(size);
    const PackedFactor<Scalar> packed = made.Pack();
    // Row k of P is unit vector order[k].
    Eigen::PermutationMatrix<Eigen::Dynamic> inverse(size);
    for (int k = 0; k < size; ++k) inverse.indices()[k] = made.order[static_cast<std::size_t>(k)];
    const Dense<Scalar> a = inverse * (made.l * made.l.adjoint()) * inverse.transpose();
    for (std::size_t columns = 1; columns <= 5; ++columns) {
      const auto b = Numbers<Scalar>(columns * packed.size(), columns);
      const Eigen::Map<const Dense<Scalar>> right(b.data(), size,
                                                  static_cast<Eigen::Index>(columns));
      const Dense<Scalar> expected = a.fullPivLu().solve(right);
      EXPECT_LE(
          Worst<Scalar>(Solve(packed, b, columns, SolveKernels()), {expected.data(), b.size()}),
          1e-12)
          << size << " unknowns, " << columns << " columns";
    }
  }
}

TYPED_TEST(PackedSolveTest, SolvesLikeCholmod) {
  using Scalar = TypeParam;
  const std::pair<int, int> shapes[] = {{1, 1}, {2, 1}, {1, 7}, {3, 2}, {20, 1}, {12, 3}};
  for (const auto& [side, blocks] : shapes) {
    const auto lower = Grids<Scalar>(side, blocks, 5);
    const auto n = static_cast<std::size_t>(lower.rows());
    const auto known = Factor<Scalar>::Make(lower, FactorLayout::kSupernodal);
    const auto packed = Factor<Scalar>::Make(lower, FactorLayout::kPacked);
    ASSERT_TRUE(known.has_value() && packed.has_value());
    EXPECT_EQ((*packed)->size(), n);
    EXPECT_GE((*packed)->bytes(), static_cast<std::size_t>(lower.nonZeros()) * sizeof(Scalar));
    Workspace w1, w2;
    for (std::size_t columns = 1; columns <= 5; ++columns) {
      const auto b = Numbers<Scalar>(n * columns, columns);
      EXPECT_LE(Worst(*(*packed)->Solve(b, columns, w1), *(*known)->Solve(b, columns, w2)), 1e-12)
          << n << " unknowns, " << columns << " columns";
    }
  }
}

TYPED_TEST(PackedSolveTest, SolvesForFewNumbersOtherThanZero) {
  using Scalar = TypeParam;
  const auto lower = Grids<Scalar>(15, 2, 6);
  const auto n = static_cast<std::size_t>(lower.rows());
  const auto known = Factor<Scalar>::Make(lower, FactorLayout::kSupernodal);
  const auto packed = Factor<Scalar>::Make(lower, FactorLayout::kPacked);
  ASSERT_TRUE(known.has_value() && packed.has_value());
  Workspace w1, w2;
  for (std::size_t v = 0; v < n; ++v) {
    std::vector<Scalar> b(2 * n);
    b[v] = Scalar(1);
    b[n + (v + 1) % n] = Scalar(0.5);
    b[n + (v + 40) % n] = Scalar(-0.5);
    const auto x = *(*packed)->Solve(b, 2, w1);
    EXPECT_LE(Worst(x, *(*known)->Solve(b, 2, w2)), 1e-12);
    // Nothing arrives in the other grid.
    const std::size_t other = v < n / 2 ? n / 2 : 0;
    for (std::size_t k = other; k < other + n / 2; ++k) ASSERT_EQ(x[k], Scalar(0));
  }
  const auto nothing = *(*packed)->Solve(std::vector<Scalar>(n), 1, w1);
  EXPECT_TRUE(SameBytes<Scalar>(nothing, std::vector<Scalar>(n)));
}

TYPED_TEST(PackedSolveTest, AColumnHasTheSameBytesInAnyCompany) {
  using Scalar = TypeParam;
  const auto lower = Grids<Scalar>(18, 1, 7);
  const auto n = static_cast<std::size_t>(lower.rows());
  const auto packed = Factor<Scalar>::Make(lower, FactorLayout::kPacked);
  ASSERT_TRUE(packed.has_value());
  auto b = Numbers<Scalar>(5 * n, 8);
  std::fill_n(b.begin() + static_cast<std::ptrdiff_t>(n), n, Scalar(-0.0));
  b[n + 3] = Scalar(-1);
  Workspace w1, w2;
  for (std::size_t columns = 1; columns <= 5; ++columns) {
    const auto all = *(*packed)->Solve(std::span(b).first(columns * n), columns, w1);
    for (std::size_t c = 0; c < columns; ++c) {
      const auto alone = *(*packed)->Solve(std::span(b).subspan(c * n, n), 1, w2);
      EXPECT_TRUE(SameBytes(all.subspan(c * n, n), alone)) << c << " of " << columns;
    }
  }
}

TYPED_TEST(PackedSolveTest, EveryMachineCodeGivesTheSameBytes) {
  using Scalar = TypeParam;
  const std::span<const PackedKernels> all = SolveKernelsHere();
  if (all.size() == 1) GTEST_SKIP() << "this processor has only the plain code";
  for (int size = 1; size <= kWidest; ++size) {
    const PackedFactor<Scalar> packed = HandMade<Scalar>(size).Pack();
    for (std::size_t columns = 1; columns <= 5; ++columns) {
      const auto b = Numbers<Scalar>(columns * packed.size(), columns);
      const auto plain = Solve(packed, b, columns, all.front());
      for (const PackedKernels& other : all.subspan(1)) {
        EXPECT_TRUE(SameBytes<Scalar>(plain, Solve(packed, b, columns, other)));
      }
    }
  }
}

TEST(PackedSolvePointsTest, GivesTheBytesOfTwoColumns) {
  const auto lower = Grids<double>(18, 1, 7);
  const auto n = static_cast<std::size_t>(lower.rows());
  const auto packed = Factor<double>::Make(lower, FactorLayout::kPacked);
  ASSERT_TRUE(packed.has_value());
  constexpr std::size_t kShapes = 3;
  auto points = Numbers<std::complex<double>>(kShapes * n, 4);
  points[3] = points[n + 1] = {-0.0, -0.0};
  Workspace w1, w2, w3;
  // Two that lie apart, in either order.
  for (const std::size_t first : {0u, 1u}) {
    const auto one = std::span(points).subspan(first * n, n);
    const auto other = std::span(points).subspan((1 - first) * n, n);
    const auto [x, y] = (*packed)->SolveBoth(one, w1, other, w2);
    EXPECT_TRUE(SameBytes(x, (*packed)->SolvePoints(one, 1, w3)));
    EXPECT_TRUE(SameBytes(y, (*packed)->SolvePoints(other, 1, w3)));
  }
  for (std::size_t shapes = 1; shapes <= kShapes; ++shapes) {
    const auto all = (*packed)->SolvePoints(std::span(points).first(shapes * n), shapes, w1);
    ASSERT_EQ(all.size(), shapes * n);
    for (std::size_t s = 0; s < shapes; ++s) {
      std::vector<double> columns;
      for (std::size_t v = 0; v < n; ++v) columns.push_back(points[s * n + v].real());
      for (std::size_t v = 0; v < n; ++v) columns.push_back(points[s * n + v].imag());
      const auto both = *(*packed)->Solve(columns, 2, w2);
      for (std::size_t v = 0; v < n; ++v) {
        const std::complex<double> expected(both[v], both[n + v]);
        ASSERT_EQ(std::memcmp(&all[s * n + v], &expected, sizeof(expected)), 0) << s << " " << v;
      }
    }
  }
}

TYPED_TEST(PackedSolveTest, IsMadeAgainAndNamesABadMatrix) {
  using Scalar = TypeParam;
  const auto lower = Grids<Scalar>(9, 1, 9);
  const auto n = static_cast<std::size_t>(lower.rows());
  auto factor = Factor<Scalar>::Analyse(lower, FactorLayout::kPacked);
  ASSERT_TRUE(factor.has_value());
  ASSERT_TRUE((*factor)->Again(lower).has_value());
  const auto b = Numbers<Scalar>(n, 1);
  Workspace w1, w2;
  const auto first = *(*factor)->Solve(b, 1, w1);
  EXPECT_FALSE((*factor)->Again(-lower).has_value());
  ASSERT_TRUE((*factor)->Again(2 * lower).has_value());
  auto half = *(*factor)->Solve(b, 1, w2);
  for (std::size_t i = 0; i < n; ++i) EXPECT_LE(std::abs(2.0 * half[i] - first[i]), 1e-12);
  const auto bad = Factor<Scalar>::Make(-lower, FactorLayout::kPacked);
  ASSERT_FALSE(bad.has_value());
  EXPECT_EQ(bad.error().kind, FaultKind::kNumerical);
}

}  // namespace
}  // namespace arap::testing
