// CHOLMOD's types, as the factors and orders of this folder use them.
#pragma once

#include <complex>
#include <cstddef>
#include <span>

#include <Eigen/SparseCore>
#include <cholmod.h>

#include "arap/base/fault.h"

namespace arap {

// CHOLMOD's state, one per thread of work. Silent; failures are seen in `status`.
class CholmodCommon {
 public:
  CholmodCommon() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.quick_return_if_not_posdef = 1;
  }
  ~CholmodCommon() { cholmod_finish(&common_); }
  CholmodCommon(const CholmodCommon&) = delete;
  CholmodCommon& operator=(const CholmodCommon&) = delete;
  cholmod_common* get() { return &common_; }

 private:
  cholmod_common common_{};
};

template <class Scalar>
inline constexpr int kXtype = CHOLMOD_REAL;
template <>
inline constexpr int kXtype<std::complex<double>> = CHOLMOD_COMPLEX;

// A view of an Eigen matrix; nothing is copied.
template <class Scalar>
cholmod_sparse CholmodView(const Eigen::SparseMatrix<Scalar>& lower) {
  cholmod_sparse view{};
  view.nrow = static_cast<std::size_t>(lower.rows());
  view.ncol = static_cast<std::size_t>(lower.cols());
  view.nzmax = static_cast<std::size_t>(lower.nonZeros());
  view.p = const_cast<int*>(lower.outerIndexPtr());
  view.i = const_cast<int*>(lower.innerIndexPtr());
  view.x = const_cast<Scalar*>(lower.valuePtr());
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = kXtype<Scalar>;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

inline std::span<const int> Indices(const void* data, std::size_t size) {
  return {static_cast<const int*>(data), size};
}

// What CHOLMOD's status says of the work `what` on so many unknowns.
Fault CholmodFault(int status, const char* what, std::size_t unknowns);

}  // namespace arap
