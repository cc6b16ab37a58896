// The numbers of supernodal factors against dense Eigen: every width and height of a block, and blocks that take from
// one another.
#include "core/sparse/supernodal.h"

#include <complex>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/sparse/factor.h"
#include "tests/core/sparse/random.h"

namespace arap::testing {
namespace {

template <class Scalar>
using Dense = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

// Hermitian and definite: dense blocks of so many unknowns, each sharing `shared` with the one before.
template <class Scalar>
Dense<Scalar> Chain(const std::vector<int>& blocks, int shared, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  int n = 0;
  for (const int size : blocks) n += n == 0 ? size : size - shared;
  Dense<Scalar> a = Dense<Scalar>::Zero(n, n);
  int begin = 0;
  for (const int size : blocks) {
    for (int i = begin; i < begin + size; ++i) {
      for (int j = begin; j < i; ++j) {
        a(i, j) = Number<Scalar>(random);
        a(j, i) = Eigen::numext::conj(a(i, j));
      }
    }
    begin += size - shared;
  }
  for (int i = 0; i < n; ++i) a(i, i) = a.row(i).cwiseAbs().sum() + 1;
  return a;
}

template <class Scalar>
Eigen::SparseMatrix<Scalar> Lower(const Dense<Scalar>& a) {
  return Eigen::SparseMatrix<Scalar>(a.sparseView()).template triangularView<Eigen::Lower>();
}

template <class Scalar>
void ExpectSolvesLikeDense(const Dense<Scalar>& a) {
  const auto factor = Factor<Scalar>::Make(Lower<Scalar>(a), FactorLayout::kPacked);
  ASSERT_TRUE(factor.has_value()) << factor.error().message;
  std::mt19937_64 random(3);
  Dense<Scalar> b(a.rows(), 3);
  for (auto& x : b.reshaped()) x = Number<Scalar>(random);
  const Dense<Scalar> expected = a.llt().solve(b);
  Workspace workspace;
  const auto x = *(*factor)->Solve({b.data(), static_cast<std::size_t>(b.size())}, 3, workspace);
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    ASSERT_LE(std::abs(x[static_cast<std::size_t>(i)] - expected.data()[i]), 1e-13);
  }
}

template <class Scalar>
class SupernodalTest : public ::testing::Test {};
using Scalars = ::testing::Types<double, std::complex<double>>;
TYPED_TEST_SUITE(SupernodalTest, Scalars);

TYPED_TEST(SupernodalTest, OneBlockOfAnyWidth) {
  for (int n = 1; n <= 75; ++n) {
    SCOPED_TRACE(n);
    ExpectSolvesLikeDense<TypeParam>(Chain<TypeParam>({n}, 0, 7));
  }
  ExpectSolvesLikeDense<TypeParam>(Chain<TypeParam>({331}, 0, 8));
}

TYPED_TEST(SupernodalTest, BlocksThatTakeFromOneAnother) {
  for (int shared = 1; shared <= 21; ++shared) {
    SCOPED_TRACE(shared);
    ExpectSolvesLikeDense<TypeParam>(
        Chain<TypeParam>({shared + 1, shared + 9, shared + 30, shared + 4}, shared, 9));
  }
  ExpectSolvesLikeDense<TypeParam>(Chain<TypeParam>({150, 170, 160}, 77, 10));
}

TYPED_TEST(SupernodalTest, ALongRowEndsInManyBlocks) {
  // An arrow: every column has the last rows.
  constexpr int kSize = 120, kTip = 13;
  auto a = Chain<TypeParam>(std::vector<int>(59, 4), 2, 11);
  ASSERT_EQ(a.rows(), kSize);
  for (int i = kSize - kTip; i < kSize; ++i) {
    for (int j = 0; j < i; ++j) {
      a(i, j) += TypeParam(0.1);
      a(j, i) = Eigen::numext::conj(a(i, j));
    }
    a(i, i) += TypeParam(kSize);
  }
  ExpectSolvesLikeDense<TypeParam>(a);
}

TYPED_TEST(SupernodalTest, TellsWhereverAMatrixIsNotDefinite) {
  using Scalar = TypeParam;
  const auto good = Chain<Scalar>({12, 30, 9}, 4, 12);
  for (const double bad : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    for (Eigen::Index k = 0; k < good.rows(); ++k) {
      auto a = good;
      a(k, k) = Scalar(bad);
      const auto factor = Factor<Scalar>::Make(Lower<Scalar>(a), FactorLayout::kPacked);
      ASSERT_FALSE(factor.has_value()) << k;
      EXPECT_EQ(factor.error().kind, FaultKind::kNumerical);
    }
  }
}

TYPED_TEST(SupernodalTest, GivesTheSameBytesAgain) {
  using Scalar = TypeParam;
  const auto lower = Lower<Scalar>(Chain<Scalar>({40, 50, 60, 30}, 11, 13));
  std::vector<Scalar> first;
  for (int round = 0; round < 3; ++round) {
    const auto factor = Factor<Scalar>::Make(lower, FactorLayout::kPacked);
    ASSERT_TRUE(factor.has_value());
    const std::vector<Scalar> b((*factor)->size(), Scalar(1));
    Workspace workspace;
    const auto x = *(*factor)->Solve(b, 1, workspace);
    if (round == 0) first.assign(x.begin(), x.end());
    for (std::size_t i = 0; i < x.size(); ++i) ASSERT_EQ(x[i], first[i]);
  }
}

// One block, dense.
template <class Scalar>
std::vector<Scalar> FactoredBy(ProductCode code, const Eigen::SparseMatrix<Scalar>& lower) {
  const auto n = static_cast<int>(lower.rows());
  std::vector<int> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  const int first[] = {0, n}, rows_begin[] = {0, n}, values_begin[] = {0, n * n};
  std::vector<Scalar> values(all.size() * all.size());
  EXPECT_TRUE(FactorSupernodes<Scalar>({first, rows_begin, all, values_begin, all}, lower,
                                       values.data(), code));
  for (int c = 0; c < n; ++c) {
    for (int r = 0; r < c; ++r) values[static_cast<std::size_t>(c * n + r)] = Scalar(0);
  }
  return values;
}

TYPED_TEST(SupernodalTest, EveryMachineCodeGivesTheSameBytes) {
  const auto best = BestProductCode();
  if (best == ProductCode::kPlain) GTEST_SKIP() << "this processor has the plain code only";
  for (const int n : {5, 31, 150}) {
    SCOPED_TRACE(n);
    const auto lower = Lower<TypeParam>(Chain<TypeParam>({n}, 0, 14));
    const auto plain = FactoredBy(ProductCode::kPlain, lower);
    EXPECT_EQ(FactoredBy(ProductCode::kAvx2, lower), plain);
    if (best == ProductCode::kAvx512) {
      EXPECT_EQ(FactoredBy(ProductCode::kAvx512, lower), plain);
    }
  }
}

}  // namespace
}  // namespace arap::testing
