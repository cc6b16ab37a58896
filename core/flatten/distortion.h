// Distortion: how far a piecewise linear mapping is from an isometry.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

namespace arap {

// Measures of a mapping, area-weighted with rest areas. s1 >= s2 are the singular values of a
// triangle's Jacobian; both enter unsigned, except in the ARAP energy, where a flipped triangle has
// s2 < 0.
struct Distortion {
  double arap_energy = 0;           // Σ A((s1−1)² + (s2−1)²) / ΣA
  double symmetric_dirichlet = 4;   // Σ A(s1² + s2² + s1⁻² + s2⁻²) / ΣA, at most 1e30
  double area_ratio = 1;            // Σ A·s1·s2 / ΣA (unsigned)
  double mean_stretch_percent = 0;  // mean of max(0, s1 − 1)
  double max_stretch_percent = 0;
  double mean_compression_percent = 0;  // mean of max(0, 1 − s2)
  double max_compression_percent = 0;
  double mean_angle_degrees = 0;  // mean of the largest change of a corner angle
  double max_angle_degrees = 0;
  std::size_t flipped = 0;
};

// Singular values s1 >= |s2| of the map from the triangle `rest` (laid flat) to `image`; s2 < 0
// when the orientation is reversed. `rest` must not be degenerate.
std::array<double, 2> SingularValues(const std::array<Complex, 3>& rest,
                                     const std::array<Complex, 3>& image);

// Lays a triangle of space flat: first corner at 0, second on the positive real axis, third above.
std::array<Complex, 3> LayFlat(const SurfaceMesh& mesh, const Triangle& triangle);

// Measures uv (#V) against the surface; per triangle singular values land in `singular_values`
// (#F).
Distortion Measure(const SurfaceMesh& mesh, std::span<const Complex> uv,
                   std::vector<std::array<double, 2>>& singular_values);

}  // namespace arap
