#include "client/cli/sample/place_handle.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace arap::cli {

void AddHandle(const PlanarMesh& mesh, const std::string& name, Point rest, Track& track) {
  // The triangle in which the point lies deepest; the smallest weight says how deep.
  TriangleAnchor best;
  double depth = -std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](std::size_t k) { return mesh.vertices[mesh.triangles[t][k]]; };
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
  TrackHandle& added = track.handles.emplace_back();
  added.handle.id = name;
  added.handle.anchor = best;
  added.rest = rest;
}

}  // namespace arap::cli
