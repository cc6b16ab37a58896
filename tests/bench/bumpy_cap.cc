#include "tests/bench/bumpy_cap.h"

#include <cmath>
#include <numbers>

#include "tests/support/random.h"

namespace arap::bench {
namespace {

constexpr double kRim = 70 * std::numbers::pi / 180;
constexpr double kJitter = 0.25;  // of the distance between two rings
constexpr double kBump = 0.04;

// Of a point of the unit disk.
Point3 OnCap(Complex p) {
  const double polar = kRim * std::abs(p), around = std::arg(p);
  const double bumps = std::sin(9 * p.real()) * std::cos(7 * p.imag() + 1) +
                       0.5 * std::sin(15 * p.imag() - 4 * p.real());
  return {std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
          std::cos(polar) + kBump * bumps};
}

// Ring k has 6k vertices; ring 0 is the middle.
std::uint32_t First(std::uint32_t ring) { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1); }
std::uint32_t At(std::uint32_t ring, std::uint32_t k) {
  return ring == 0 ? 0 : First(ring) + k % (6 * ring);
}

}  // namespace

SurfaceMesh BumpyCap(std::size_t triangles) {
  const auto rings =
      static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(triangles) / 6)));
  const double step = 1.0 / rings;
  testing::Random random(triangles);
  SurfaceMesh mesh;
  mesh.vertices.push_back(OnCap(0));
  for (std::uint32_t ring = 1; ring <= rings; ++ring) {
    for (std::uint32_t k = 0; k < 6 * ring; ++k) {
      const Complex place = std::polar(step * ring, 2 * std::numbers::pi * k / (6 * ring));
      const Complex off(random.Uniform(-1, 1), random.Uniform(-1, 1));
      mesh.vertices.push_back(OnCap(place + kJitter * step * off));
    }
  }
  // Between two rings every sixth part has one triangle more on the outside.
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t sixth = 0; sixth < 6; ++sixth) {
      const std::uint32_t inner = sixth * ring, outer = sixth * (ring + 1);
      for (std::uint32_t k = 0; k <= ring; ++k) {
        mesh.triangles.push_back(
            {At(ring, inner + k), At(ring + 1, outer + k), At(ring + 1, outer + k + 1)});
        if (k == ring) break;
        mesh.triangles.push_back(
            {At(ring, inner + k), At(ring + 1, outer + k + 1), At(ring, inner + k + 1)});
      }
    }
  }
  return mesh;
}

}  // namespace arap::bench
