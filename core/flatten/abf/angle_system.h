// The constrained least squares behind angle-based flattening: one Newton step after another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/SparseCore>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/flatten/abf/abf.h"
#include "core/mesh/topology.h"
#include "core/sparse/factor.h"

namespace arap {

// Angles on their way to fit: minimises Σ ((α − β)/β)² under the constraints linearised at the
// present angles α, again and again; β are the targets. Rows 2i and 2i + 1 are the angle sum and
// the wheel of interior vertex i. The rows of the triangles are eliminated by hand: within a
// triangle the projected weights diag(w) − wwᵗ/Σw, w = β², are all that is left of them.
//
// Keeps references to the triangles. Not thread-safe.
class AngleSystem {
 public:
  // Around the corners of triangles in `left_out` (#F or empty) nothing has to fit.
  AngleSystem(const std::vector<Triangle>& triangles, const Topology& topology,
              const std::vector<bool>& left_out = {});

  // Interior vertices; without any, there is nothing to solve.
  std::size_t interior() const { return count_; }

  // Takes the angles of the surface as targets, scaled to sum to 2π around every interior vertex
  // and clamped to be those of a triangle. Answers them scaled to sum to π in every triangle: where
  // to start.
  std::vector<TriangleAngles> Target(std::vector<TriangleAngles> angles);

  // By row: 2π minus the angle sum, and minus the sum of log sines.
  std::vector<double> Residual(const std::vector<TriangleAngles>& angles) const;

  // One step from `angles`, which it replaces; answers the largest relative change that it wanted.
  // The angles stay in (0, π): a triangle that would turn a corner inside out goes only part of the
  // way, and that corner is stiffer from then on. Fault: kNumerical.
  Result<double> Step(std::vector<TriangleAngles>& angles);

 private:
  struct Local;
  Local At(std::size_t t, const TriangleAngles& angles) const;
  std::uint32_t Row(std::size_t t, int p) const;
  // Calls visit(triangle, corner, number of the interior vertex there).
  template <class Visit>
  void ForEachCorner(Visit visit) const;
  Eigen::SparseMatrix<double> Assemble(const std::vector<TriangleAngles>& angles,
                                       std::vector<double>& right);

  const std::vector<Triangle>& triangles_;
  std::size_t count_ = 0;
  std::vector<std::uint32_t> interior_;  // #V, kNone at other vertices
  std::vector<TriangleAngles> target_;   // β, #F
  std::vector<TriangleAngles> freedom_;  // factors of the weights, 1 unless stiffened, #F
  std::vector<Eigen::Triplet<double, int>> triplets_;
  std::vector<int> order_;  // the pattern is the same in every step
  Workspace workspace_;
};

}  // namespace arap
