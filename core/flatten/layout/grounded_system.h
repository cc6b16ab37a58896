// GroundedSystem: a step matrix with some vertices held, factored.
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include "arap/base/result.h"
#include "core/base/try.h"
#include "core/sparse/factor.h"

namespace arap {

// An elimination order, shared by the systems of one pattern.
using Order = std::shared_ptr<const std::vector<int>>;

// Solves M x = f for the vertices that are free, with the others at given places. Scalar is double
// or std::complex<double>. Immutable; thread-safe with a Workspace per thread.
template <class Scalar>
class GroundedSystem {
 public:
  // `lower` (#n×#n, lower triangle) is the matrix with nothing held; `fixed` (#n) says what is.
  // `order` is an elimination order of a pattern around this one. Faults: those of Factor::Make.
  static Result<GroundedSystem> Make(const Eigen::SparseMatrix<Scalar>& lower,
                                     std::vector<bool> fixed, FactorLayout layout,
                                     const Order& order) {
    GroundedSystem system;
    Eigen::SparseMatrix<Scalar> grounded(lower.rows(), lower.cols());
    grounded.reserve(lower.nonZeros() + lower.cols());
    for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
      grounded.startVec(column);
      const auto c = static_cast<std::size_t>(column);
      if (fixed[c]) grounded.insertBack(column, column) = Scalar(1);
      for (typename Eigen::SparseMatrix<Scalar>::InnerIterator it(lower, column); it; ++it) {
        const auto r = static_cast<std::size_t>(it.row());
        if (!fixed[r] && !fixed[c]) {
          grounded.insertBack(it.row(), column) = it.value();
        } else if (!fixed[r]) {
          system.couplings_.push_back({r, c, it.value()});
        } else if (!fixed[c]) {
          system.couplings_.push_back({c, r, Eigen::numext::conj(it.value())});
        }
      }
    }
    grounded.finalize();
    TRY(system.factor_, Factor<Scalar>::Make(grounded, layout, *order));
    system.fixed_ = std::move(fixed);
    system.order_ = order;
    return system;
  }

  // `x` (#n × columns, one after the other) comes with the places of the held vertices and leaves
  // with all; `right` alike is scratch that comes with f. kNumerical when memory runs out.
  Status Solve(std::span<Scalar> right, std::size_t columns, std::span<Scalar> x,
               Workspace& workspace) const {
    const std::size_t n = fixed_.size();
    for (std::size_t k = 0; k < columns; ++k) {
      for (const Coupling& c : couplings_) right[k * n + c.free] -= c.value * x[k * n + c.held];
      for (std::size_t v = 0; v < n; ++v) {
        if (fixed_[v]) right[k * n + v] = x[k * n + v];
      }
    }
    const auto solution = factor_->Solve(right, columns, workspace);
    if (solution.empty()) {
      return Fail(FaultKind::kNumerical, "A back-substitution ran out of memory.");
    }
    std::copy(solution.begin(), solution.end(), x.begin());
    return {};
  }

  const Factor<Scalar>& factor() const { return *factor_; }
  const Order& order() const { return order_; }
  // By how much the diagonal was raised before factoring, if it was.
  double raised() const { return raised_; }
  void set_raised(double raised) { raised_ = raised; }
  std::size_t bytes() const {
    return factor_->bytes() + couplings_.capacity() * sizeof(Coupling) + fixed_.size() / 8;
  }

 private:
  struct Coupling {
    std::size_t free, held;
    Scalar value;
  };
  double raised_ = 0;
  std::vector<bool> fixed_;
  std::vector<Coupling> couplings_;
  Order order_;
  std::shared_ptr<const Factor<Scalar>> factor_;
};

}  // namespace arap
