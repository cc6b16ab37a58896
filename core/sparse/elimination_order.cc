#include "core/sparse/elimination_order.h"

#include "core/sparse/cholmod_types.h"
#include "core/sparse/dissection.h"

namespace arap {
namespace {

// What find(matrix, order, common) makes of the matrix.
template <class Scalar, class Find>
Result<std::vector<int>> Ordered(const Eigen::SparseMatrix<Scalar>& lower, Find find) {
  CholmodCommon common;
  cholmod_sparse matrix = CholmodView(lower);
  std::vector<int> order(static_cast<std::size_t>(lower.rows()));
  const int ok = find(&matrix, order.data(), common.get());
  if (!ok || common.get()->status != CHOLMOD_OK) {
    return Fail(CholmodFault(common.get()->status, "Ordering", order.size()));
  }
  return order;
}

}  // namespace

template <class Scalar>
Result<std::vector<int>> EliminationOrder(const Eigen::SparseMatrix<Scalar>& lower) {
  return Ordered(lower, [](cholmod_sparse* matrix, int* order, cholmod_common* common) {
    return cholmod_amd(matrix, nullptr, 0, order, common);
  });
}

template <class Scalar>
Result<std::vector<int>> EliminationOrder(const Eigen::SparseMatrix<Scalar>& lower,
                                          std::span<const std::complex<double>> points) {
  const auto n = static_cast<std::size_t>(lower.rows());
  std::vector<int> stages =
      DissectionStages({Indices(lower.outerIndexPtr(), n + 1),
                        Indices(lower.innerIndexPtr(), static_cast<std::size_t>(lower.nonZeros()))},
                       points);
  return Ordered(lower, [&](cholmod_sparse* matrix, int* order, cholmod_common* common) {
    return cholmod_camd(matrix, nullptr, 0, stages.data(), order, common);
  });
}

template Result<std::vector<int>> EliminationOrder(const Eigen::SparseMatrix<double>&);
template Result<std::vector<int>> EliminationOrder(
    const Eigen::SparseMatrix<std::complex<double>>&);
template Result<std::vector<int>> EliminationOrder(const Eigen::SparseMatrix<double>&,
                                                   std::span<const std::complex<double>>);
template Result<std::vector<int>> EliminationOrder(const Eigen::SparseMatrix<std::complex<double>>&,
                                                   std::span<const std::complex<double>>);

}  // namespace arap
