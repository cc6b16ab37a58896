#include "core/mesh/plane.h"

#include <algorithm>
#include <limits>

namespace arap {

std::array<double, 3> Barycentric(const std::array<Complex, 3>& c, Complex p) {
  const double area = TwiceArea(c[0], c[1], c[2]);
  const double b1 = TwiceArea(c[0], p, c[2]) / area;
  const double b2 = TwiceArea(c[0], c[1], p) / area;
  return {1 - b1 - b2, b1, b2};
}

std::optional<Located> LocateIn(std::span<const Complex> vertices,
                                std::span<const Triangle> triangles, std::uint32_t triangle,
                                Complex p, double tolerance) {
  const Triangle& t = triangles[triangle];
  auto b = Barycentric({vertices[t[0]], vertices[t[1]], vertices[t[2]]}, p);
  // A NaN from a degenerate triangle fails these comparisons.
  if (!(b[0] >= -tolerance && b[1] >= -tolerance && b[2] >= -tolerance)) return std::nullopt;
  double sum = 0;
  for (double& x : b) sum += x = std::max(x, 0.0);
  for (double& x : b) x /= sum;
  return Located{triangle, b, 0};
}

std::optional<Located> Locate(std::span<const Complex> vertices,
                              std::span<const Triangle> triangles, Complex p, double tolerance) {
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (auto found = LocateIn(vertices, triangles, t, p, tolerance)) return found;
  }
  return std::nullopt;
}

Located NearestOnBoundary(std::span<const Complex> vertices, std::span<const Triangle> triangles,
                          const Topology& topology, Complex p) {
  Located best;
  best.distance = std::numeric_limits<double>::infinity();
  for (const Edge& edge : topology.edges) {
    if (!edge.boundary()) continue;
    const Complex a = vertices[edge.v0], d = vertices[edge.v1] - a;
    const double s = std::clamp(std::real(std::conj(d) * (p - a)) / std::norm(d), 0.0, 1.0);
    const double distance = std::abs(a + s * d - p);
    if (distance >= best.distance) continue;
    best = {edge.triangle[0], {}, distance};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[edge.triangle[0]][k];
      best.barycentric[k] = v == edge.v0 ? 1 - s : v == edge.v1 ? s : 0;
    }
  }
  return best;
}

}  // namespace arap
