// DirichletPasses: the symmetric Dirichlet energy of a layout as a function of the shape, with what
// a descent without its Hessian has to know. Every method is one pass over the triangles, in
// kernels that take several at once; newton.h has the words and the second derivatives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/SparseCore>

#include "arap/model/mesh.h"
#include "core/base/wide.h"
#include "core/energy/local_step.h"

namespace arap {

// Of triangles, by column: corners; w of the second and the third corner (a corner's part in α, and
// conjugated in β); share of the rest area; one over twice the rest area.
struct DirichletTable {
  std::vector<std::uint32_t> v0, v1, v2;
  std::vector<double> w1_x, w1_y, w2_x, w2_y, share, inverse;

  std::size_t size() const { return v0.size(); }
};

// Plain and wide machine code give the same bytes.
class DirichletPasses {
 public:
  // Triangles in the mask `left_out` (#F or empty) have no energy. `wide`: with the wide machine
  // code of the kernels.
  DirichletPasses(const SurfaceMesh& mesh, const std::vector<bool>& left_out,
                  bool wide = HasWide());

  // The energy of `v` less its least value 4, infinite where a triangle is not upright. `pull` (#V
  // each) becomes −∇E.
  double Pull(ConstShapeView v, ShapeView pull, std::size_t vertices) const;

  // What lies along v + t·d, for upright `v`: the least t at which a triangle collapses (infinite
  // when none ever does), and d²E/dt² at t = 0, which may be negative.
  struct Ahead {
    double limit, curvature;
  };
  Ahead Look(ConstShapeView v, ConstShapeView d) const;

  // A matrix of zeros with the pattern of the next one: the lower triangle, #V×#V, and all of the
  // diagonal.
  Eigen::SparseMatrix<double> Pattern(std::size_t vertices);

  // Fills that of the last Pattern with a stiffness matrix that stands for the Hessian, for x and y
  // alike: every triangle counts with the mean of its four eigenvalues, those of an isometry or,
  // given an upright layout, its own where they are not negative. Semidefinite.
  void Fill(const ConstShapeView* layout, Eigen::SparseMatrix<double>& lower) const;

 private:
  double MeanEigenvalue(std::size_t triangle, ConstShapeView v) const;

  DirichletTable table_;
  std::vector<std::array<int, 6>> slots_;  // of the lower 3×3 triangle of each, among the values
  bool wide_;
};

}  // namespace arap
