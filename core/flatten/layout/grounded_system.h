// GroundedSystem: a step matrix with some vertices held, factored.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
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
  // `lower` (#n×#n, lower triangle with all of the diagonal) is the matrix with nothing held; `fixed` (#n)
  // says what is. `order` is an elimination order of a pattern around this one. Faults: those of Factor::Make.
  static Result<GroundedSystem> Make(Eigen::SparseMatrix<Scalar> lower, std::vector<bool> fixed,
                                     FactorLayout layout, const Order& order) {
    GroundedSystem system;
    system.Ground(fixed, lower);
    auto factor = Factor<Scalar>::Make(lower, layout, *order);
    for (double lift = kFirstLift;
         !factor && factor.error().kind == FaultKind::kNumerical && lift <= kLastLift;
         lift *= kMoreLift) {
      system.Lift(lift, fixed, lower);
      factor = Factor<Scalar>::Make(lower, layout, *order);
    }
    if (!factor) return Fail(std::move(factor).error());
    system.factor_ = *std::move(factor);
    system.fixed_ = std::move(fixed);
    system.order_ = order;
    return system;
  }

  // `x` (#n × columns, one after the other) comes with the places of the held vertices and leaves
  // with all; `right` alike is scratch that comes with f. Fault: kOutOfMemory.
  Status Solve(std::span<Scalar> right, std::size_t columns, std::span<Scalar> x,
               Workspace& workspace) const {
    const std::size_t n = fixed_.size();
    for (std::size_t k = 0; k < columns; ++k) {
      for (const Coupling& c : couplings_) right[k * n + c.free] -= c.value * x[k * n + c.held];
      for (std::size_t v = 0; v < n; ++v) {
        if (fixed_[v]) right[k * n + v] = x[k * n + v];
      }
    }
    TRY(const auto solution, factor_->Solve(right, columns, workspace));
    std::copy(solution.begin(), solution.end(), x.begin());
    if (lifted_.empty()) return {};
    // (M + L) x ← f + L x rests where M x = f.
    std::vector<Scalar> again(right.size());
    for (int step = 0; step < kLiftSteps; ++step) {
      for (std::size_t i = 0; i < right.size(); ++i) again[i] = right[i] + lifted_[i % n] * x[i];
      TRY(const auto better, factor_->Solve(again, columns, workspace));
      std::copy(better.begin(), better.end(), x.begin());
    }
    return {};
  }

  // Whether the matrix was not definite in doubles, as very thin triangles make it.
  bool lifted() const { return !lifted_.empty(); }
  const Factor<Scalar>& factor() const { return *factor_; }
  const Order& order() const { return order_; }
  // By how much the diagonal was raised before factoring, if it was.
  double raised() const { return raised_; }
  void set_raised(double raised) { raised_ = raised; }
  std::size_t bytes() const {
    return factor_->bytes() + couplings_.capacity() * sizeof(Coupling) + fixed_.size() / 8 +
           lifted_.capacity() * sizeof(double);
  }

 private:
  // Rounding leaves the matrices of very thin triangles with eigenvalues below 0. Free vertices are
  // held back a little then, by these parts of their own diagonal, and let go again step by step
  // when solving.
  static constexpr double kFirstLift = 1e-13, kMoreLift = 1e2, kLastLift = 1e-5;
  static constexpr int kLiftSteps = 8;

  // Makes rows and columns of fixed vertices those of the identity, in place, and keeps what they were.
  void Ground(const std::vector<bool>& fixed, Eigen::SparseMatrix<Scalar>& matrix) {
    int *outer = matrix.outerIndexPtr(), *inner = matrix.innerIndexPtr();
    Scalar* values = matrix.valuePtr();
    int end = 0;
    for (std::size_t c = 0; c < fixed.size(); ++c) {
      const int from = std::exchange(outer[c], end), to = outer[c + 1];
      for (int at = from; at < to; ++at) {
        const auto r = static_cast<std::size_t>(inner[at]);
        if (fixed[r] == fixed[c] && (!fixed[r] || r == c)) {
          inner[end] = inner[at];
          values[end++] = fixed[r] ? Scalar(1) : values[at];
        } else if (!fixed[r]) {
          couplings_.push_back({r, c, values[at]});
        } else if (!fixed[c]) {
          couplings_.push_back({c, r, Eigen::numext::conj(values[at])});
        }
      }
    }
    outer[fixed.size()] = end;
    matrix.resizeNonZeros(end);
  }

  void Lift(double part, const std::vector<bool>& fixed, Eigen::SparseMatrix<Scalar>& matrix) {
    lifted_.resize(fixed.size(), 0);
    for (std::size_t v = 0; v < fixed.size(); ++v) {
      if (fixed[v]) continue;
      Scalar& diagonal =
          matrix.coeffRef(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(v));
      const double own = std::abs(std::real(diagonal) - lifted_[v]);
      diagonal += part * own - lifted_[v];
      lifted_[v] = part * own;
    }
  }

  struct Coupling {
    std::size_t free, held;
    Scalar value;
  };
  double raised_ = 0;
  std::vector<double> lifted_;  // #n, or empty when the matrix is definite
  std::vector<bool> fixed_;
  std::vector<Coupling> couplings_;
  Order order_;
  std::shared_ptr<const Factor<Scalar>> factor_;
};

}  // namespace arap
