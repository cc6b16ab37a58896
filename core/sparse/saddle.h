// Saddle: the small dense system of the null-space form [algorithm §2]
//
//     [ C Z + E   C N ] [λ]   [ r ]
//     [ (C N)ᴴ    −S  ] [α] = [ 0 ]
//
// with one row per active constraint. S is the energy of the directions N: 0 where they are the
// null space. Non-singular by construction: E is the compliance, hard rows are independent, and
// every component in it has two distinct points.
#pragma once

#include <cstddef>

#include <Eigen/LU>

namespace arap {

// Scalar is double or std::complex<double>. Immutable after construction; Solve allocates nothing.
template <class Scalar>
class Saddle {
 public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

  Saddle() = default;
  // `cz` (k×k) with the compliance on its diagonal already, `cn` (k×m).
  Saddle(const Matrix& cz, const Matrix& cn) : Saddle(cz, cn, Matrix::Zero(cn.cols(), cn.cols())) {}
  // `energy` is S (m×m).
  Saddle(const Matrix& cz, const Matrix& cn, const Matrix& energy) {
    const Eigen::Index k = cz.rows(), m = cn.cols();
    if (k == 0) return;
    matrix_.resize(k + m, k + m);
    matrix_.topLeftCorner(k, k) = cz;
    matrix_.topRightCorner(k, m) = cn;
    matrix_.bottomLeftCorner(m, k) = cn.adjoint();
    matrix_.bottomRightCorner(m, m) = -energy;
    lu_.compute(matrix_);
  }

  Eigen::Index size() const { return matrix_.rows(); }

  // One stream's scratch; Resize once.
  struct Scratch {
    Vector right, solution, residual, permuted;
    void Resize(Eigen::Index size) {
      for (Vector* v : {&right, &solution, &residual, &permuted}) v->setZero(size);
    }
  };

  // scratch.solution := solution for scratch.right, with one step of refinement.
  void Solve(Scratch& scratch) const {
    if (size() == 0) return;
    SolveOnce(scratch.right, scratch.solution);
    scratch.residual = scratch.right;
    scratch.residual.noalias() -= matrix_ * scratch.solution;
    SolveOnce(scratch.residual, scratch.permuted);
    scratch.solution += scratch.permuted;
  }

 private:
  // LU::solve and permutations in place allocate; this does not.
  void SolveOnce(const Vector& right, Vector& solution) const {
    solution.noalias() = lu_.permutationP() * right;
    lu_.matrixLU().template triangularView<Eigen::UnitLower>().solveInPlace(solution);
    lu_.matrixLU().template triangularView<Eigen::Upper>().solveInPlace(solution);
  }

  Matrix matrix_;
  Eigen::PartialPivLU<Matrix> lu_;
};

}  // namespace arap
