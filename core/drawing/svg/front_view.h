// A surface as it is seen from in front.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/client/mesh.h"
#include "core/drawing/svg/view.h"

namespace arap::cli {

// The parallel projection along the mean normal of a surface, y of the space upwards where that is
// possible. Lengths across the view are kept.
class FrontView {
 public:
  explicit FrontView(const client::SurfaceMesh& mesh);

  // x y x y… of the vertices.
  const std::vector<double>& points() const { return points_; }
  // Larger is nearer to the eye.
  double Depth(std::size_t vertex) const { return depths_[vertex]; }

 private:
  std::vector<double> points_;
  std::vector<double> depths_;
};

// Paths that show the surface with a checkerboard on it, squares of side `square` of the plane of
// `uv` through `corner_uv`; shaded, the nearest last. Backs are plain.
std::string CheckeredSurface(const client::SurfaceMesh& mesh, const FrontView& front,
                             std::span<const double> uv, std::span<const std::uint32_t> corner_uv,
                             double square, const View& view);

}  // namespace arap::cli
