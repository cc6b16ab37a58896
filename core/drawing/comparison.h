// Several layouts of one surface side by side, each with the surface as it is seen from in front.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "arap/model/flatten.h"
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

struct ComparisonPanel {
  std::string label;
  Flattening flat;                 // with singular values
  std::vector<std::string> lines;  // beneath the picture
};

// For each panel the surface from in front with a checkerboard that the layout maps onto it, and
// the layout at the scale of the surface, turned to the same side and coloured by strain; one scale
// and one legend for all. A panel without flat positions shows its lines alone.
std::string FormatComparison(const SurfaceMesh& mesh, const std::vector<ComparisonPanel>& panels,
                             const std::string& caption);

}  // namespace arap
