#include "tests/bench/layout_quality.h"

#include <vector>

#include "core/flatten/distortion.h"
#include "core/mesh/space.h"

namespace arap::bench {
namespace {

double Area(const SurfaceMesh& mesh, const Triangle& t) {
  const auto& p = mesh.vertices;
  return 0.5 * TwiceArea(p[t[0]], p[t[1]], p[t[2]]);
}

// The least over c of Σ A((c·s1 − 1)² + (c·s2 − 1)²) / ΣA.
double ScaledEnergy(const SurfaceMesh& mesh, std::span<const std::array<double, 2>> values) {
  double squares = 0, sums = 0, area = 0;
  for (std::size_t t = 0; t < values.size(); ++t) {
    const auto [s1, s2] = values[t];
    if (s1 == 0 && s2 == 0) continue;  // left out
    const double a = Area(mesh, mesh.triangles[t]);
    squares += a * (s1 * s1 + s2 * s2);
    sums += a * (s1 + s2);
    area += a;
  }
  return (2 * area - sums * sums / squares) / area;
}

}  // namespace

LayoutQuality QualityOf(const SurfaceMesh& mesh, const Flattening& flat) {
  return {flat.distortion, ScaledEnergy(mesh, flat.singular_values)};
}

LayoutQuality QualityOf(const SurfaceMesh& mesh, std::span<const Complex> uv) {
  const auto measure = [&](bool mirror) {
    DistortionSum sum;
    std::vector<std::array<double, 2>> values;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<Complex, 3> image;
      for (std::size_t k = 0; k < 3; ++k) {
        const Complex at = uv[mesh.triangles[t][k]];
        image[k] = mirror ? std::conj(at) : at;
      }
      const auto measured = MeasureTriangle(LayFlat(mesh, mesh.triangles[t]), image);
      sum.Add(measured, 1, t);
      values.push_back(measured.singular_values);
    }
    return LayoutQuality{sum.Mean(), ScaledEnergy(mesh, values)};
  };
  const LayoutQuality upright = measure(false);
  return 2 * upright.distortion.flipped > mesh.triangles.size() ? measure(true) : upright;
}

}  // namespace arap::bench
