// The unit hemisphere flattened as rigidly as possible, without any mesh: the rotationally
// symmetric continuous problem.
#pragma once

#include <cstddef>
#include <vector>

namespace arap::testing {

// A point at polar angle θ goes to the radius r(θ). The map stretches by r′ along meridians and by
// r/sin θ along parallels, and r minimises the mean over the area (2π) of
// (r′ − 1)² + (r/sin θ − 1)²: ∫ that · sin θ dθ from 0 to π/2.
struct FlatHemisphere {
  double arap_energy = 0;
  std::vector<double> radius;  // at θ = k·π/(2n), k = 0…n
};

// With r piecewise linear over `elements` equal parts: one tridiagonal system. The error of the
// energy falls with the square of `elements`.
FlatHemisphere FlattenHemisphere(std::size_t elements);

}  // namespace arap::testing
