// DirichletPasses: the symmetric Dirichlet energy of a layout as a function of the shape, with what
// a descent without its Hessian has to know. Every method is one pass over the triangles, in
// kernels that take several at once; newton.h has the words and the second derivatives.
//
// With b = |β| and the determinant D the energy less 4 is 4b²(1 + 1/D²) + 2(D − 1)²/D: no roots, one
// division, and nothing that cancels near an isometry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/SparseCore>

#include "arap/model/mesh.h"
#include "core/energy/local_step.h"

namespace arap {

// Of triangles, by column: corners; w of the second and the third corner (a corner's part in α, and
// conjugated in β); share of the rest area; one over twice the rest area.
struct DirichletTable {
  std::vector<std::int32_t> v0, v1, v2;
  std::vector<double> w1_x, w1_y, w2_x, w2_y, share, inverse;

  std::size_t size() const { return v0.size(); }
};

// Of triangles begin…, at most kKernelBlock, where a layout is pairs of numbers.
struct DirichletKernels {
  void (*pull)(const DirichletTable& table, std::size_t begin, std::size_t count, const double* v,
               CornerPulls& out);
  // `nearest` is twice the largest of what one over the way to a triangle's collapse is, at least 0.
  void (*look)(const DirichletTable& table, std::size_t begin, std::size_t count, const double* v,
               const double* d, double& nearest, double& curvature);
};

// Those that this processor has: the plain one first, the best last. All give the same bytes.
std::span<const DirichletKernels> DirichletKernelsHere();

class DirichletPasses {
 public:
  // Triangles in the mask `left_out` (#F or empty) have no energy.
  DirichletPasses(const SurfaceMesh& mesh, const std::vector<bool>& left_out,
                  const DirichletKernels& kernels = DirichletKernelsHere().back());

  // The energy of `v` (#V) less its least value 4, infinite where a triangle is not upright by more
  // than rounding (Upright). `pull` (#V) becomes −∇E.
  double Pull(std::span<const Complex> v, std::span<Complex> pull) const;

  // What lies along v + t·d, for upright `v`: the least t at which a triangle collapses (infinite
  // when none ever does), and d²E/dt² at t = 0, which may be negative.
  struct Ahead {
    double limit, curvature;
  };
  Ahead Look(std::span<const Complex> v, std::span<const Complex> d) const;

  // A matrix of zeros with the pattern of the next one: the lower triangle, #V×#V, and all of the
  // diagonal.
  Eigen::SparseMatrix<double> Pattern(std::size_t vertices);

  // Fills that of the last Pattern with a stiffness matrix that stands for the Hessian, for x and y
  // alike: of an isometry or, given an upright layout (#V, else empty), its own. Along each of the
  // two directions in which a triangle is stretched it is as stiff as the Hessian on average of what
  // moves there, what is negative left out. Semidefinite.
  void Fill(std::span<const Complex> layout, Eigen::SparseMatrix<double>& lower) const;

 private:
  DirichletTable table_;
  std::vector<std::array<int, 6>> slots_;  // of the lower 3×3 triangle of each, among the values
  const DirichletKernels& kernels_;
};

}  // namespace arap
