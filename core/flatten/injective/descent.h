// Two descents by Newton steps: one that pushes flips out, one that never makes any.
#pragma once

#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/flatten/injective/newton.h"

namespace arap {

// What both descents work on: the energy and the triangles that count.
struct DescentProblem {
  Newton& newton;
  std::span<const Triangle> triangles;
  const std::vector<bool>& left_out;  // #F or empty
  const CancelToken& cancel;          // asked before every step
};

// Moves `uv` until every triangle is upright, or until no more flips have gone for a while: look at
// the result. Adds its steps to `iterations`. Faults: kNumerical, what the token answers.
// [Garanzha et al. 2021]
Status Untangle(const DescentProblem& problem, std::vector<Complex>& uv, int& iterations);

// Descends the symmetric Dirichlet energy from an upright layout through upright layouts, until a
// step brings less than the fraction `stop` of what is above an isometry, or `max_iterations` are
// done. Steps count as above. [Smith and Schaefer 2015]
Status Descend(const DescentProblem& problem, double stop, int max_iterations,
               std::vector<Complex>& uv, int& iterations);

}  // namespace arap
