#include "client/cli/sample/place_handle.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace arap::cli {

void AddHandle(const client::PlanarMesh& mesh, const std::string& name, Point rest, Track& track) {
  // The triangle in which the point lies deepest; the smallest weight says how deep.
  client::TriangleAnchor best;
  double depth = -std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto corner = [&](std::size_t k) {
      const std::size_t v = mesh.triangles[3 * t + k];
      return Point(mesh.vertices[2 * v], mesh.vertices[2 * v + 1]);
    };
    const Point a = corner(0), b = corner(1), c = corner(2);
    const double area = Cross(b - a, c - a);
    const std::array<double, 3> weights{Cross(b - rest, c - rest) / area,
                                        Cross(c - rest, a - rest) / area,
                                        Cross(a - rest, b - rest) / area};
    const double smallest = *std::min_element(weights.begin(), weights.end());
    if (smallest > depth) {
      depth = smallest;
      best = {static_cast<std::uint32_t>(t), weights};
    }
  }
  track.handles.push_back({name, rest.real(), rest.imag(), best});
}

}  // namespace arap::cli
