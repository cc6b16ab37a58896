// A surface as it is seen from in front.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "arap/model/mesh.h"
#include "core/drawing/svg.h"

namespace arap {

// The parallel projection along the mean normal of a surface, y of the space upwards where that is
// possible. Lengths across the view are kept.
class FrontView {
 public:
  explicit FrontView(const SurfaceMesh& mesh);

  // Of the vertices (#V).
  const std::vector<Complex>& points() const { return points_; }
  // Larger is nearer to the eye.
  double Depth(std::size_t vertex) const { return depths_[vertex]; }

 private:
  std::vector<Complex> points_;
  std::vector<double> depths_;
};

// Paths that show the surface with a checkerboard on it, squares of side `square` of the plane of
// `uv` through `corner_uv`; shaded, the nearest last. Backs are plain.
std::string CheckeredSurface(const SurfaceMesh& mesh, const FrontView& front,
                             std::span<const Complex> uv, std::span<const Triangle> corner_uv,
                             double square, const View& view);

}  // namespace arap
