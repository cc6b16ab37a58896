#include "tests/support/surfaces.h"

#include <array>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "core/mesh/space.h"
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
      result.surface.vertices.push_back({profile[i].real(), along, profile[i].imag()});
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
      result.surface.vertices.push_back(
          {radius * sine * std::cos(space), radius * sine * std::sin(space), -radius * cosine});
    }
  }
  result.surface.triangles =
      GridTriangles(sectors, rings, [&](std::size_t, std::size_t) { return random.Coin(); });
  return result;
}

SurfaceMesh SphereCap(std::size_t rings, std::size_t sectors, double polar_angle) {
  SurfaceMesh mesh;
  mesh.vertices.push_back({0, 0, 1});
  for (std::size_t r = 1; r <= rings; ++r) {
    const double polar = polar_angle * static_cast<double>(r) / static_cast<double>(rings);
    for (std::size_t s = 0; s < sectors; ++s) {
      const double azimuth =
          2 * std::numbers::pi * static_cast<double>(s) / static_cast<double>(sectors);
      mesh.vertices.push_back({std::sin(polar) * std::cos(azimuth),
                               std::sin(polar) * std::sin(azimuth), std::cos(polar)});
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

SurfaceMesh Sphere(std::size_t rings, std::size_t sectors) {
  // A cap down to the last ring but one, closed with a fan around the south pole.
  const double polar =
      std::numbers::pi * static_cast<double>(rings - 1) / static_cast<double>(rings);
  SurfaceMesh mesh = SphereCap(rings - 1, sectors, polar);
  const auto south = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto last = static_cast<std::uint32_t>(south - sectors);
  mesh.vertices.push_back({0, 0, -1});
  for (std::uint32_t s = 0; s < sectors; ++s) {
    const auto next = static_cast<std::uint32_t>((s + 1) % sectors);
    mesh.triangles.push_back({last + s, south, last + next});
  }
  return mesh;
}

SurfaceMesh Torus(std::size_t around, std::size_t across, double radius, double tube) {
  SurfaceMesh mesh;
  const auto angle = [](std::size_t i, std::size_t n) {
    return 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
  };
  const auto index = [&](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>((i % around) * across + j % across);
  };
  for (std::size_t i = 0; i < around; ++i) {
    for (std::size_t j = 0; j < across; ++j) {
      const double a = angle(i, around), b = angle(j, across), r = radius + tube * std::cos(b);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), tube * std::sin(b)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return mesh;
}

SurfaceMesh PlateWithHoles(std::size_t holes, std::size_t cells) {
  using Point = std::array<int, 3>;
  const int n = static_cast<int>(cells), length = static_cast<int>(2 * holes + 1);
  const auto solid = [&](const Point& c) {
    if (c[0] < 0 || c[0] >= length || c[1] < 0 || c[1] >= 3 || c[2] != 0) return false;
    return c[0] % 2 == 0 || c[1] != 1;
  };
  SurfaceMesh mesh;
  std::map<Point, std::uint32_t> numbers;  // by lattice point, in units of 1 / cells
  const auto number = [&](const Point& p) {
    const auto [it, fresh] = numbers.emplace(p, mesh.vertices.size());
    if (fresh) mesh.vertices.push_back(ToPoint3(Eigen::Vector3d(p[0], p[1], p[2]) / n));
    return it->second;
  };
  // Between every cube and the space behind each of its faces.
  const auto add_face = [&](const Point& cube, std::size_t axis, int side) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const auto corner = [&](int di, int dj) {
          Point p{};
          p[axis] = (cube[axis] + side) * n;
          p[u] = cube[u] * n + i + di;
          p[v] = cube[v] * n + j + dj;
          return number(p);
        };
        std::array<std::uint32_t, 4> c{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
        if (side == 0) std::swap(c[1], c[3]);
        mesh.triangles.push_back({c[0], c[1], c[2]});
        mesh.triangles.push_back({c[0], c[2], c[3]});
      }
    }
  };
  for (int x = 0; x < length; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (std::size_t axis = 0; axis < 3 && solid({x, y, 0}); ++axis) {
        for (const int side : {0, 1}) {
          Point behind{x, y, 0};
          behind[axis] += 2 * side - 1;
          if (!solid(behind)) add_face({x, y, 0}, axis, side);
        }
      }
    }
  }
  return mesh;
}

SurfaceMesh MoebiusBand(std::size_t n) {
  SurfaceMesh band;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(a / 2);
      band.vertices.push_back({r * std::cos(a), r * std::sin(a), s * std::sin(a / 2)});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * i + 1;
    const bool last = i + 1 == n;  // the last cell closes with its ends swapped
    const std::uint32_t c = last ? 1 : 2 * i + 2, d = last ? 0 : 2 * i + 3;
    band.triangles.push_back({a, c, b});
    band.triangles.push_back({b, c, d});
  }
  return band;
}

SurfaceMesh Together(const SurfaceMesh& first, const SurfaceMesh& second,
                     const Eigen::Vector3d& shift) {
  SurfaceMesh both = first;
  const auto offset = static_cast<std::uint32_t>(first.vertices.size());
  for (const auto& p : second.vertices) both.vertices.push_back(ToPoint3(Vec(p) + shift));
  for (const Triangle& t : second.triangles) {
    both.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return both;
}

}  // namespace arap::testing
