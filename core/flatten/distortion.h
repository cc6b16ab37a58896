// Distortion: how far a piecewise linear mapping is from an isometry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "arap/model/flatten.h"

namespace arap {

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
