// Surfaces of unit diagonal with their boundary loops, for the tests of injective layouts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "arap/model/mesh.h"
#include "core/mesh/space.h"
#include "tests/support/random.h"
#include "tests/support/surfaces.h"

namespace arap::testing {

inline constexpr double kHard = std::numeric_limits<double>::infinity();
using Loops = std::vector<std::vector<std::uint32_t>>;

// Boundary loops in the direction of their triangles, longest first.
inline Loops WalkLoops(const SurfaceMesh& mesh) {
  std::map<std::uint32_t, std::uint32_t> next;
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> sides;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) sides[{t[k], t[(k + 1) % 3]}] = true;
  }
  for (const auto& [side, _] : sides) {
    if (!sides.contains({side.second, side.first})) next[side.first] = side.second;
  }
  Loops loops;
  while (!next.empty()) {
    loops.emplace_back();
    for (auto at = next.begin(); at != next.end();) {
      loops.back().push_back(at->first);
      const std::uint32_t v = at->second;
      next.erase(at);
      at = next.find(v);
    }
  }
  const auto length = [&](const std::vector<std::uint32_t>& loop) {
    double sum = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      sum += (Vec(mesh.vertices[loop[k]]) - Vec(mesh.vertices[loop[(k + 1) % loop.size()]])).norm();
    }
    return sum;
  };
  std::stable_sort(loops.begin(), loops.end(),
                   [&](const auto& a, const auto& b) { return length(a) > length(b); });
  return loops;
}

inline SurfaceMesh UnitDiagonal(SurfaceMesh mesh) {
  Eigen::Vector3d low = Vec(mesh.vertices[0]), high = low;
  for (const auto& p : mesh.vertices) low = low.cwiseMin(Vec(p)), high = high.cwiseMax(Vec(p));
  const double diagonal = (high - low).norm();
  for (auto& p : mesh.vertices) p = ToPoint3((Vec(p) - low) / diagonal);
  return mesh;
}

// The cap of the unit sphere that holds `share` of its area.
inline SurfaceMesh Cap(std::size_t rings, std::size_t sectors, double share) {
  return UnitDiagonal(SphereCap(rings, sectors, std::acos(1 - 2 * share)));
}

inline SurfaceMesh Lifted(const PlanarMesh& mesh) {
  SurfaceMesh result;
  for (const Complex p : mesh.vertices) {
    result.vertices.push_back({p.real(), p.imag(), 0.3 * std::sin(p.real()) * p.imag()});
  }
  result.triangles = mesh.triangles;
  return UnitDiagonal(result);
}

inline std::vector<Complex> Noise(std::size_t count, double size, std::uint64_t seed) {
  Random random(seed);
  std::vector<Complex> noise(count);
  for (Complex& z : noise) {
    const double x = random.Uniform(-size, size), y = random.Uniform(-size, size);
    z = {x, y};
  }
  return noise;
}

// Plane positions of a planar mesh scaled like its lifted surface.
inline std::vector<Complex> From(const PlanarMesh& mesh, double scale) {
  std::vector<Complex> uv = mesh.vertices;
  for (Complex& z : uv) z *= scale;
  return uv;
}

}  // namespace arap::testing
