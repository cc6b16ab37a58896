// A descent of the symmetric Dirichlet energy that seldom factors, and small matrices: conjugate
// gradients in the inner product of a stiffness matrix.
#pragma once

#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/flatten/injective/newton.h"
#include "core/sparse/factor.h"

namespace arap {

struct GradientsOptions {
  int max_iterations = 0;
  // Converged: two steps in a row lower what the energy has above 4 by less than this fraction.
  double stop = 0;
  std::span<const LayoutPin> pins;  // of InjectiveOptions
  const std::vector<bool>& left_out;
};

struct GradientsResult {
  int iterations = 0;
  bool converged = false;  // else more steps, or better ones, would lower the energy
  FactorTimes times;
};

// Moves `uv` (#V), an upright layout that meets the hard pins, through such layouts; no step raises
// the energy. Every direction is conjugate to the last one (Hestenes–Stiefel with Dai and Yuan's
// bound), every step is Newton's along it, short of where a triangle would collapse [Smith and
// Schaefer 2015]. The matrix is first that of an isometry; it is made anew from the layout when
// steps have come to bring less than all of them did on average, a matrix counted as many. Faults:
// kOutOfMemory, and what `cancel` answers before every step.
Result<GradientsResult> DescendGradients(const SurfaceMesh& mesh, const GradientsOptions& options,
                                         const CancelToken& cancel, std::vector<Complex>& uv);

}  // namespace arap
