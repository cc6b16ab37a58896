#include "core/outline/smooth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "core/base/plane.h"

namespace arap {

double SmallestAngle(Complex a, Complex b, Complex c) {
  const auto at = [](Complex corner, Complex next, Complex last) {
    return std::atan2(Cross(next - corner, last - corner), Dot(next - corner, last - corner));
  };
  return std::min({at(a, b, c), at(b, c, a), at(c, a, b)}) * 180 / std::numbers::pi;
}

void Smooth(const std::vector<bool>& fixed, PlanarMesh& mesh) {
  constexpr int kRounds = 5;
  constexpr double kGoodAngle = 28;
  // The triangles of each vertex, one after another.
  const std::size_t n = mesh.vertices.size();
  std::vector<std::size_t> begin(n + 1);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) ++begin[v + 1];
  }
  for (std::size_t v = 0; v < n; ++v) begin[v + 1] += begin[v];
  std::vector<std::size_t> around(begin[n]), end = begin;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) around[end[v]++] = t;
  }

  const auto smallest = [&](std::size_t v) {
    double angle = 180;
    for (std::size_t i = begin[v]; i < begin[v + 1]; ++i) {
      const Triangle& t = mesh.triangles[around[i]];
      angle = std::min(
          angle, SmallestAngle(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
    }
    return angle;
  };
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t v = 0; v < n; ++v) {
      if (fixed[v] || begin[v] == begin[v + 1]) continue;
      Complex sum = 0;
      for (std::size_t i = begin[v]; i < begin[v + 1]; ++i) {
        for (const std::uint32_t corner : mesh.triangles[around[i]]) {
          if (corner != v) sum += mesh.vertices[corner];
        }
      }
      const double before = std::min(smallest(v), kGoodAngle);
      const Complex old = mesh.vertices[v];
      mesh.vertices[v] = sum / (2.0 * static_cast<double>(begin[v + 1] - begin[v]));
      if (smallest(v) < before) mesh.vertices[v] = old;
    }
  }
}

}  // namespace arap
