// The two walks that Newton's steps take: out of flips, and down the symmetric Dirichlet energy.
#pragma once

#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/flatten/injective/newton.h"

namespace arap {

// What steps go by, of this descent and of conjugate gradients. An energy this near to an isometry
// is rounding; a step brings this part of what its slope says at least; it ends before the one that
// would collapse a triangle.
inline constexpr double kExactLayout = 1e-20;
inline constexpr double kArmijo = 1e-4;
inline constexpr double kBeforeCollapse = 0.9;
inline constexpr double kLeastStep = 1e-12, kLargestStep = 1e6;

// What both walks work on: the energy and the triangles that count.
struct DescentProblem {
  Newton& newton;
  std::span<const Triangle> triangles;
  const std::vector<bool>& left_out;  // #F or empty
  const CancelToken& cancel;          // asked before every step
};

// Moves `uv` until every triangle is upright, or until no more flips have gone for `patience`
// steps: look at the result. Adds its steps to `iterations`. Faults: kNumerical, what the token
// answers. [Garanzha et al. 2021]
Status Untangle(const DescentProblem& problem, int patience, std::vector<Complex>& uv,
                int& iterations);

// Descends the symmetric Dirichlet energy from an upright layout through upright layouts, until a
// step brings less than the fraction `stop` of what is above an isometry, or `max_iterations` are
// done. Steps count as above. [Smith and Schaefer 2015]
Status Descend(const DescentProblem& problem, double stop, int max_iterations,
               std::vector<Complex>& uv, int& iterations);

}  // namespace arap
