// The CHOLMOD room against dense Eigen, in both layouts, real and complex.
#include "core/sparse/factor.h"

#include <filesystem>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/core/sparse/random.h"
#include "tests/support/bounded.h"

namespace arap::testing {
namespace {

// Sparse, Hermitian, diagonally dominant.
template <class Scalar>
Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> RandomMatrix(int n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> a =
      Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>::Zero(n, n);
  for (int k = 0; k < 4 * n; ++k) {
    const auto i = static_cast<int>(random() % static_cast<std::uint64_t>(n));
    const auto j = static_cast<int>(random() % static_cast<std::uint64_t>(n));
    if (i == j) continue;
    const Scalar x = Number<Scalar>(random);
    a(i, j) += x;
    a(j, i) = Eigen::numext::conj(a(i, j));
  }
  for (int i = 0; i < n; ++i) a(i, i) = a.row(i).cwiseAbs().sum() + 1;
  return a;
}

template <class Scalar>
class FactorTest : public ::testing::Test {};
using Scalars = ::testing::Types<double, std::complex<double>>;
TYPED_TEST_SUITE(FactorTest, Scalars);

std::size_t Threads() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    ++count;
  }
  return count;
}

// Nobody's threads but the caller's: what a factor costs is told by its own clock, and nothing waits
// for more work at full speed.
TYPED_TEST(FactorTest, WakesNoThread) {
  using Scalar = TypeParam;
  if (!std::filesystem::exists("/proc/self/task")) GTEST_SKIP() << "The system does not tell.";
  constexpr int kSide = 60;
  Eigen::SparseMatrix<Scalar> lower(kSide * kSide, kSide * kSide);
  for (int i = 0; i < kSide * kSide; ++i) {
    lower.insert(i, i) = Scalar(4.1);
    if (i % kSide + 1 < kSide) lower.insert(i + 1, i) = Scalar(-1);
    if (i + kSide < kSide * kSide) lower.insert(i + kSide, i) = Scalar(-1);
  }
  lower.makeCompressed();
  const std::size_t before = Threads();
  for (const FactorLayout layout :
       {FactorLayout::kSupernodal, FactorLayout::kSimplicial, FactorLayout::kPacked}) {
    const auto factor = Factor<Scalar>::Make(lower, layout);
    ASSERT_TRUE(factor.has_value()) << factor.error().message;
    Workspace workspace;
    const std::vector<Scalar> right(8 * kSide * kSide, Scalar(1));
    ASSERT_TRUE((*factor)->Solve(right, 8, workspace).has_value());
    EXPECT_EQ(Threads(), before);
  }
}

TYPED_TEST(FactorTest, SolvesLikeADenseFactorisation) {
  using Scalar = TypeParam;
  for (const FactorLayout layout : {FactorLayout::kSupernodal, FactorLayout::kSimplicial}) {
    const auto a = RandomMatrix<Scalar>(120, 5);
    const Eigen::SparseMatrix<Scalar> lower =
        Eigen::SparseMatrix<Scalar>(a.sparseView()).template triangularView<Eigen::Lower>();
    const auto factor = Factor<Scalar>::Make(lower, layout);
    ASSERT_TRUE(factor.has_value()) << factor.error().message;
    Workspace workspace;
    std::mt19937_64 random(9);
    for (const std::size_t columns : {1u, 2u, 7u}) {
      Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> b(120, columns);
      for (auto& x : b.reshaped()) x = Number<Scalar>(random);
      const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> expected = a.llt().solve(b);
      const auto x =
          *(*factor)->Solve({b.data(), static_cast<std::size_t>(b.size())}, columns, workspace);
      ASSERT_EQ(x.size(), static_cast<std::size_t>(b.size()));
      for (Eigen::Index i = 0; i < b.size(); ++i) {
        EXPECT_LE(std::abs(x[static_cast<std::size_t>(i)] - expected.data()[i]), 1e-13);
      }
    }
  }
}

TYPED_TEST(FactorTest, TakesTheOrderOfAnother) {
  using Scalar = TypeParam;
  const auto a = RandomMatrix<Scalar>(60, 6);
  const Eigen::SparseMatrix<Scalar> lower =
      Eigen::SparseMatrix<Scalar>(a.sparseView()).template triangularView<Eigen::Lower>();
  const auto first = Factor<Scalar>::Make(lower, FactorLayout::kSimplicial);
  ASSERT_TRUE(first.has_value());
  const auto second = Factor<Scalar>::Make(lower, FactorLayout::kSimplicial, (*first)->order());
  ASSERT_TRUE(second.has_value());
  std::vector<Scalar> b(60, Scalar(1));
  Workspace w1, w2;
  const auto x = *(*first)->Solve(b, 1, w1), y = *(*second)->Solve(b, 1, w2);
  for (std::size_t i = 0; i < b.size(); ++i) EXPECT_LE(std::abs(x[i] - y[i]), 1e-14);
}

TYPED_TEST(FactorTest, FactorsTheSamePatternAgain) {
  using Scalar = TypeParam;
  for (const FactorLayout layout : {FactorLayout::kSupernodal, FactorLayout::kSimplicial}) {
    const auto a = RandomMatrix<Scalar>(90, 10);
    const Eigen::SparseMatrix<Scalar> lower =
        Eigen::SparseMatrix<Scalar>(a.sparseView()).template triangularView<Eigen::Lower>();
    auto factor = Factor<Scalar>::Analyse(lower, layout);
    ASSERT_TRUE(factor.has_value()) << factor.error().message;
    const std::vector<Scalar> b(90, Scalar(1));
    Workspace workspace;
    ASSERT_TRUE((*factor)->Again(lower).has_value());
    const auto once = *(*factor)->Solve(b, 1, workspace);
    const std::vector<Scalar> first(once.begin(), once.end());
    EXPECT_FALSE((*factor)->Again(-lower).has_value());  // and a failure does no lasting harm
    ASSERT_TRUE((*factor)->Again(2 * lower).has_value());
    const auto half = *(*factor)->Solve(b, 1, workspace);
    for (std::size_t i = 0; i < b.size(); ++i) EXPECT_LE(std::abs(2.0 * half[i] - first[i]), 1e-14);
    ASSERT_TRUE((*factor)->Again(lower).has_value());
    const auto again = *(*factor)->Solve(b, 1, workspace);
    for (std::size_t i = 0; i < b.size(); ++i) EXPECT_EQ(again[i], first[i]);
  }
}

TYPED_TEST(FactorTest, NamesAMatrixThatIsNotPositiveDefinite) {
  using Scalar = TypeParam;
  auto a = RandomMatrix<Scalar>(30, 7);
  a(4, 4) = Scalar(-1);
  const Eigen::SparseMatrix<Scalar> lower =
      Eigen::SparseMatrix<Scalar>(a.sparseView()).template triangularView<Eigen::Lower>();
  for (const FactorLayout layout : {FactorLayout::kSupernodal, FactorLayout::kSimplicial}) {
    const auto factor = Factor<Scalar>::Make(lower, layout);
    ASSERT_FALSE(factor.has_value());
    EXPECT_EQ(factor.error().kind, FaultKind::kNumerical);
  }
}

TYPED_TEST(FactorTest, IsSharedByThreadsWithEqualBytes) {
  using Scalar = TypeParam;
  const auto a = RandomMatrix<Scalar>(200, 8);
  const Eigen::SparseMatrix<Scalar> lower =
      Eigen::SparseMatrix<Scalar>(a.sparseView()).template triangularView<Eigen::Lower>();
  const auto factor = Factor<Scalar>::Make(lower, FactorLayout::kSupernodal);
  ASSERT_TRUE(factor.has_value());
  std::vector<std::vector<Scalar>> answers(4);
  std::vector<BoundedThread> threads;
  for (auto& answer : answers) {
    threads.emplace_back("a thread that solves", [&answer, &factor] {
      Workspace workspace;
      const std::vector<Scalar> b(400, Scalar(1));
      for (int i = 0; i < 20; ++i) {
        const auto x = *(*factor)->Solve(b, 2, workspace);
        answer.assign(x.begin(), x.end());
      }
    });
  }
  threads.clear();
  for (const auto& answer : answers) EXPECT_EQ(answer, answers[0]);
}

}  // namespace
}  // namespace arap::testing
