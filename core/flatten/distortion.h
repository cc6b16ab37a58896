// Distortion: how far a piecewise linear mapping is from an isometry, and whether it is injective
// around every point.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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

// Counter-clockwise by more than the rounding of its corners' coordinates, so that the sign of the
// area is certain and stays when the layout is scaled. False when a coordinate is not finite.
bool Upright(Complex a, Complex b, Complex c);

// Triangles that are not upright, ascending; those in the mask `left_out` (#F or empty) do not
// count.
std::vector<std::uint32_t> NotUpright(std::span<const Triangle> triangles,
                                      std::span<const Complex> uv,
                                      const std::vector<bool>& left_out = {});

// Inner vertices whose upright triangles go round them more than once (a branch point of the map),
// ascending. `boundary` (#V) marks the vertices that are not inner. Needs a layout whose triangles
// are all upright; nothing is decided at vertices of triangles left out.
std::vector<std::uint32_t> WoundTwice(std::span<const Triangle> triangles,
                                      std::span<const Complex> uv,
                                      const std::vector<bool>& boundary,
                                      const std::vector<bool>& left_out = {});

// Whether all triangles that count are upright and no inner vertex is wound twice: the layout is
// injective around every point. Far parts of it may still overlap.
bool LocallyInjective(std::span<const Triangle> triangles, std::span<const Complex> uv,
                      const std::vector<bool>& boundary, const std::vector<bool>& left_out = {});

}  // namespace arap
