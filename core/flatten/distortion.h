// Distortion: how far a piecewise linear mapping is from an isometry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

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
  std::uint32_t worst_triangle = 0;  // with the largest max(s1, 1/s2)
};

// Singular values s1 >= |s2| of the map from the triangle `rest` (laid flat) to `image`; s2 < 0
// when the orientation is reversed. `rest` must not be degenerate.
std::array<double, 2> SingularValues(const std::array<Complex, 3>& rest,
                                     const std::array<Complex, 3>& image);

// Lays a triangle of space flat: first corner at 0, second on the positive real axis, third above.
std::array<Complex, 3> LayFlat(const SurfaceMesh& mesh, const Triangle& triangle);

// One triangle's share. `rest` and `image` in one unit.
struct TriangleDistortion {
  std::array<double, 2> singular_values{};
  double area = 0;   // at rest
  double angle = 0;  // largest change of a corner angle, radians
};
TriangleDistortion MeasureTriangle(const std::array<Complex, 3>& rest,
                                   const std::array<Complex, 3>& image);

// Adds triangles up to the means.
class DistortionSum {
 public:
  // `unit` takes the triangle's area to that of the others; `id` names it.
  void Add(const TriangleDistortion& triangle, double unit, std::uint32_t id);
  Distortion Mean() const;

 private:
  Distortion sum_ = Zero();
  double total_ = 0;
  double worst_ = 0;

  static Distortion Zero();
};

}  // namespace arap
