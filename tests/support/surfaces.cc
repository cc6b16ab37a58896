#include "tests/support/surfaces.h"

#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>

#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace arap::testing {
namespace {

// A sheet whose cross-section is a polyline of nx equal segments; `turn(i)` is the angle at inner
// point i. Vertices slide along their rulings by a random part of a cell, so that the triangulation
// is irregular.
Developable BentSheet(std::size_t nx, std::size_t ny, double width, double height,
                      std::uint64_t seed, const std::function<double(std::size_t)>& turn) {
  Random random(seed);
  const double step = width / static_cast<double>(nx);
  const double rise = height / static_cast<double>(ny);
  std::vector<Complex> profile{Complex(0, 0)};
  double heading = 0;
  for (std::size_t i = 0; i < nx; ++i) {
    if (i > 0) heading += turn(i);
    profile.push_back(profile.back() + std::polar(step, heading));
  }
  Developable result;
  for (std::size_t j = 0; j <= ny; ++j) {
    for (std::size_t i = 0; i <= nx; ++i) {
      const double along = rise * (static_cast<double>(j) + random.Uniform(-0.3, 0.3));
      result.flat.emplace_back(step * static_cast<double>(i), along);
      result.surface.vertices.emplace_back(profile[i].real(), along, profile[i].imag());
    }
  }
  result.surface.triangles =
      GridTriangles(nx, ny, [&](std::size_t, std::size_t) { return random.Coin(); });
  return result;
}

}  // namespace

Developable RolledSheet(std::size_t nx, std::size_t ny, double width, double height, double turns,
                        std::uint64_t seed) {
  const double angle = 2 * std::numbers::pi * turns / static_cast<double>(nx);
  return BentSheet(nx, ny, width, height, seed, [angle](std::size_t) { return angle; });
}

Developable Accordion(std::size_t nx, std::size_t ny, double width, double height, double fold,
                      std::uint64_t seed) {
  return BentSheet(nx, ny, width, height, seed,
                   [fold](std::size_t i) { return i % 2 == 0 ? fold : -fold; });
}

Developable ConePatch(std::size_t sectors, std::size_t rings, double inner, double outer,
                      double flat_angle, double space_angle, std::uint64_t seed) {
  assert(flat_angle < space_angle && space_angle < 2 * std::numbers::pi);
  Random random(seed);
  const double flat_step = flat_angle / static_cast<double>(sectors);
  const double space_step = space_angle / static_cast<double>(sectors);
  // The half angle of the cone at which neighbouring rulings enclose flat_step.
  const double sine = std::sin(flat_step / 2) / std::sin(space_step / 2);
  const double cosine = std::sqrt(1 - sine * sine);
  const double rise = (outer - inner) / static_cast<double>(rings);
  Developable result;
  for (std::size_t j = 0; j <= rings; ++j) {
    for (std::size_t i = 0; i <= sectors; ++i) {
      const double radius = outer - rise * (static_cast<double>(j) + random.Uniform(-0.2, 0.2));
      const double flat = flat_step * static_cast<double>(i);
      const double space = space_step * static_cast<double>(i);
      result.flat.push_back(std::polar(radius, flat));
      result.surface.vertices.emplace_back(radius * sine * std::cos(space),
                                           radius * sine * std::sin(space), -radius * cosine);
    }
  }
  result.surface.triangles =
      GridTriangles(sectors, rings, [&](std::size_t, std::size_t) { return random.Coin(); });
  return result;
}

SurfaceMesh SphereCap(std::size_t rings, std::size_t sectors, double polar_angle) {
  SurfaceMesh mesh;
  mesh.vertices.emplace_back(0, 0, 1);
  for (std::size_t r = 1; r <= rings; ++r) {
    const double polar = polar_angle * static_cast<double>(r) / static_cast<double>(rings);
    for (std::size_t s = 0; s < sectors; ++s) {
      const double azimuth =
          2 * std::numbers::pi * static_cast<double>(s) / static_cast<double>(sectors);
      mesh.vertices.emplace_back(std::sin(polar) * std::cos(azimuth),
                                 std::sin(polar) * std::sin(azimuth), std::cos(polar));
    }
  }
  const auto index = [&](std::size_t r, std::size_t s) {
    return static_cast<std::uint32_t>(1 + (r - 1) * sectors + s % sectors);
  };
  for (std::size_t s = 0; s < sectors; ++s) {
    mesh.triangles.push_back({0, index(1, s), index(1, s + 1)});
  }
  for (std::size_t r = 1; r < rings; ++r) {
    for (std::size_t s = 0; s < sectors; ++s) {
      mesh.triangles.push_back({index(r, s), index(r + 1, s), index(r + 1, s + 1)});
      mesh.triangles.push_back({index(r, s), index(r + 1, s + 1), index(r, s + 1)});
    }
  }
  return mesh;
}

}  // namespace arap::testing
