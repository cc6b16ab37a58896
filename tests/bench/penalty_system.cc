#include "tests/bench/penalty_system.h"

#include <algorithm>
#include <cstdlib>
#include <utility>
#include <vector>

#include <cholmod.h>

namespace arap::bench {

class PenaltySystem::Data {
 public:
  Data(Eigen::SparseMatrix<double> lower, bool supernodal) : matrix(std::move(lower)) {
    base.assign(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros());
    cholmod_start(&common);
    common.print = 0;
    common.supernodal = supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_AMD;  // METIS saves little here and takes longer
    auto sparse = View();
    factor = cholmod_analyze(&sparse, &common);
    if (factor == nullptr) std::abort();
  }
  ~Data() {
    cholmod_free_dense(&x, &common);
    cholmod_free_dense(&y, &common);
    cholmod_free_dense(&e, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  // Of the matrix; nothing is copied.
  cholmod_sparse View() {
    cholmod_sparse view{};
    view.nrow = view.ncol = static_cast<std::size_t>(matrix.rows());
    view.nzmax = static_cast<std::size_t>(matrix.nonZeros());
    view.p = matrix.outerIndexPtr();
    view.i = matrix.innerIndexPtr();
    view.x = matrix.valuePtr();
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = view.packed = 1;
    return view;
  }

  Eigen::SparseMatrix<double> matrix;
  std::vector<double> base;  // the values without penalties
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  cholmod_dense *x = nullptr, *y = nullptr, *e = nullptr;  // kept between solves
};

PenaltySystem::PenaltySystem(Eigen::SparseMatrix<double> lower, bool supernodal)
    : data_(std::make_unique<Data>(std::move(lower), supernodal)) {}
PenaltySystem::~PenaltySystem() = default;

void PenaltySystem::Clear() { std::ranges::copy(data_->base, data_->matrix.valuePtr()); }

void PenaltySystem::Add(Eigen::Index row, Eigen::Index column, double value) {
  if (row >= column) data_->matrix.coeffRef(row, column) += value;
}

void PenaltySystem::Factor() {
  auto sparse = data_->View();
  cholmod_factorize(&sparse, data_->factor, &data_->common);
  const bool done = data_->common.status == CHOLMOD_OK && data_->factor->minor == sparse.nrow;
  if (!done) std::abort();
}

const double* PenaltySystem::Solve(std::span<const double> right, std::size_t columns) {
  cholmod_dense view{};
  view.nrow = view.d = data_->factor->n;
  view.ncol = columns;
  view.nzmax = right.size();
  view.x = const_cast<double*>(right.data());  // read only
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  if (!cholmod_solve2(CHOLMOD_A, data_->factor, &view, nullptr, &data_->x, nullptr, &data_->y,
                      &data_->e, &data_->common)) {
    std::abort();
  }
  return static_cast<const double*>(data_->x->x);
}

std::size_t PenaltySystem::bytes() const {
  const cholmod_factor& f = *data_->factor;
  const std::size_t numbers = f.is_super ? f.xsize : f.nzmax;
  const std::size_t indices = f.is_super ? f.ssize : f.nzmax;
  const auto entries = static_cast<std::size_t>(data_->matrix.nonZeros());
  return numbers * sizeof(double) + indices * sizeof(int) + f.n * 9 * sizeof(int) +
         entries * (2 * sizeof(double) + sizeof(int));
}

}  // namespace arap::bench
