#include "tests/support/hard_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "tests/support/meshes.h"
#include "tests/support/random.h"

namespace arap::testing {
namespace {

using std::numbers::pi;

using Map = std::function<Point3(double, double)>;

// exp(−d²/size²)
double Bump(double x, double y, double size) { return std::exp(-(x * x + y * y) / (size * size)); }

// A number raised to a power with its sign.
double Power(double x, double exponent) {
  return std::copysign(std::pow(std::abs(x), exponent), x);
}

// Takes triangles away until no vertex has more than two edges of the boundary, and vertices
// without triangles.
SurfaceMesh Pruned(SurfaceMesh mesh) {
  for (bool changed = true; changed;) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
    for (const Triangle& t : mesh.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        ++sides[std::minmax(t[k], t[(k + 1) % 3])];
      }
    }
    std::vector<int> edges(mesh.vertices.size(), 0);
    for (const auto& [side, count] : sides) {
      if (count == 1) ++edges[side.first], ++edges[side.second];
    }
    const auto pinched = [&](const Triangle& t) {
      return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return edges[v] > 2; });
    };
    changed = std::erase_if(mesh.triangles, pinched) > 0;
  }
  constexpr std::uint32_t kGone = 0xffffffff;
  std::vector<std::uint32_t> place(mesh.vertices.size(), kGone);
  std::vector<Point3> kept;
  for (Triangle& t : mesh.triangles) {
    for (std::uint32_t& v : t) {
      if (place[v] == kGone) {
        place[v] = static_cast<std::uint32_t>(kept.size());
        kept.push_back(mesh.vertices[v]);
      }
      v = place[v];
    }
  }
  mesh.vertices = std::move(kept);
  return mesh;
}

// nx × ny cells over [0, 1]², irregular, mapped to space; without the triangles whose middle is in
// an opening.
SurfaceMesh Sheet(std::size_t nx, std::size_t ny, std::uint64_t seed, const Map& map,
                  const std::function<bool(double, double)>& open = {}) {
  Random random(seed);
  std::vector<std::array<double, 2>> places;
  SurfaceMesh mesh;
  for (std::size_t j = 0; j <= ny; ++j) {
    for (std::size_t i = 0; i <= nx; ++i) {
      const double shift_u = random.Uniform(-0.25, 0.25), shift_v = random.Uniform(-0.25, 0.25);
      const double u =
          (static_cast<double>(i) + (i == 0 || i == nx ? 0 : shift_u)) / static_cast<double>(nx);
      const double v =
          (static_cast<double>(j) + (j == 0 || j == ny ? 0 : shift_v)) / static_cast<double>(ny);
      places.push_back({u, v});
      mesh.vertices.push_back(map(u, v));
    }
  }
  mesh.triangles = GridTriangles(nx, ny, [&](std::size_t, std::size_t) { return random.Coin(); });
  if (!open) return mesh;
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    double u = 0, v = 0;
    for (const std::uint32_t k : t) u += places[k][0] / 3, v += places[k][1] / 3;
    return open(u, v);
  });
  return Pruned(std::move(mesh));
}

// Rings around a pole; `map` takes the part of the way out, in (0, 1], and the angle.
SurfaceMesh Rings(std::size_t rings, std::size_t sectors, std::uint64_t seed, const Map& map) {
  Random random(seed);
  SurfaceMesh mesh;
  mesh.vertices.push_back(map(0, 0));
  for (std::size_t r = 1; r <= rings; ++r) {
    for (std::size_t s = 0; s < sectors; ++s) {
      const double out = random.Uniform(-0.2, 0.2), along = random.Uniform(-0.2, 0.2);
      mesh.vertices.push_back(
          map((static_cast<double>(r) + (r == rings ? 0 : out)) / static_cast<double>(rings),
              2 * pi * (static_cast<double>(s) + along) / static_cast<double>(sectors)));
    }
  }
  const auto at = [&](std::size_t r, std::size_t s) {
    return static_cast<std::uint32_t>(1 + (r - 1) * sectors + s % sectors);
  };
  for (std::size_t s = 0; s < sectors; ++s) mesh.triangles.push_back({0, at(1, s), at(1, s + 1)});
  for (std::size_t r = 1; r < rings; ++r) {
    for (std::size_t s = 0; s < sectors; ++s) {
      mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  }
  return mesh;
}

}  // namespace

SurfaceMesh DeepCup(std::size_t size) {
  constexpr double kWall = 3;
  return Rings(size, size / 2, 1, [](double out, double angle) -> Point3 {
    const double along = out * (pi / 2 + kWall);  // from the pole
    const double polar = std::min(along, pi / 2), wall = along - polar;
    return {std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
            std::cos(polar) - wall};
  });
}

SurfaceMesh CarBody(std::size_t size) {
  constexpr std::array<std::array<double, 3>, 11> kOpenings{{{.5, .5, .09},
                                                             {.28, .5, .07},
                                                             {.72, .5, .08},
                                                             {.35, .17, .055},
                                                             {.52, .16, .06},
                                                             {.35, .83, .055},
                                                             {.52, .84, .06},
                                                             {.15, .2, .06},
                                                             {.15, .8, .06},
                                                             {.84, .2, .065},
                                                             {.84, .8, .065}}};
  return Sheet(
      size, size / 2, 2,
      [](double u, double v) -> Point3 {
        const double a = 0.49 * pi * (2 * u - 1), b = 0.49 * pi * (2 * v - 1);
        const double roof = 1 + 0.5 * Bump(u - 0.45, 0, 0.18);
        return {2.2 * Power(std::sin(a), 0.7), 0.9 * Power(std::sin(b), 0.7),
                0.8 * roof * std::pow(std::cos(a), 0.6) * std::pow(std::cos(b), 0.5)};
      },
      [&](double u, double v) {
        return std::any_of(kOpenings.begin(), kOpenings.end(), [&](const auto& hole) {
          return std::hypot(u - hole[0], 0.6 * (v - hole[1])) < hole[2];
        });
      });
}

SurfaceMesh Starfish(std::size_t size) {
  return Rings(size, 2 * size, 3, [](double out, double angle) -> Point3 {
    const double reach = 0.22 + 0.9 * std::pow(std::abs(std::cos(2.5 * angle)), 8);
    const double r = out * reach;
    const double across = std::sin(2.5 * angle) * r;
    return {r * std::cos(angle), r * std::sin(angle),
            0.9 * std::cos(1.7 * r) - 1.5 * across * across + 0.04 * std::sin(14 * r)};
  });
}

SurfaceMesh TwistedRibbon(std::size_t size) {
  return Sheet(size, std::max<std::size_t>(size / 50, 3), 4, [](double u, double v) -> Point3 {
    const double along = 60 * u, across = v - 0.5, turn = 6 * pi * u;
    return {along, across * std::cos(turn), across * std::sin(turn)};
  });
}

SurfaceMesh DentedRibbon(std::size_t size) {
  return Sheet(size, std::max<std::size_t>(size / 50, 3), 5, [](double u, double v) -> Point3 {
    const double along = 60 * u, across = v - 0.5;
    const double dent = std::sin(2.3 * along) * std::cos(pi * across) * (1 + std::sin(0.4 * along));
    return {along, across, 2 * std::sin(0.5 * along) + 0.12 * dent};
  });
}

SurfaceMesh TeeBody(std::size_t size) {
  // A grid around the body would need a seam: rings around the neck, opened.
  SurfaceMesh mesh = Rings(size, size, 6, [](double out, double angle) -> Point3 {
    const double polar = 2.6 * out;
    const double sleeve = 1 + 0.9 * (Bump(polar - 1.2, std::remainder(angle, 2 * pi), 0.45) +
                                     Bump(polar - 1.2, std::remainder(angle - pi, 2 * pi), 0.45));
    return {sleeve * std::sin(polar) * std::cos(angle), 0.6 * std::sin(polar) * std::sin(angle),
            1.5 * std::cos(polar)};
  });
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    double x = 0, z = 0;
    for (const std::uint32_t v : t) x += mesh.vertices[v][0] / 3, z += mesh.vertices[v][2] / 3;
    return z > 1.4 || std::abs(x) > 1.5;
  });
  return Pruned(std::move(mesh));
}

SurfaceMesh Face(std::size_t size) {
  return Sheet(size, size, 7, [](double u, double v) -> Point3 {
    // The square bent to a disk.
    const double a = 2 * u - 1, b = 2 * v - 1;
    const double x = a * std::sqrt(1 - b * b / 2), y = b * std::sqrt(1 - a * a / 2);
    const double dome = 1.1 * std::sqrt(std::max(0.0, 1.05 - x * x - y * y));
    const double nose = 0.55 * std::exp(-x * x / 0.012 - (y + 0.05) * (y + 0.05) / 0.05);
    const double eyes = Bump(x - 0.35, y - 0.25, 0.13) + Bump(x + 0.35, y - 0.25, 0.13);
    const double mouth = std::exp(-x * x / 0.06 - (y + 0.45) * (y + 0.45) / 0.004);
    return {0.8 * x, y, dome + nose - 0.35 * eyes - 0.15 * mouth};
  });
}

SurfaceMesh Paw(std::size_t size) {
  return Rings(size, size, 8, [](double out, double angle) -> Point3 {
    const double polar = 1.9 * out;
    const double x = std::sin(polar) * std::cos(angle), y = std::sin(polar) * std::sin(angle),
                 z = std::cos(polar);
    double reach = 1;
    for (int k = 0; k < 4; ++k) {
      const double towards = pi / 2 * k + 0.3;
      const double fx = 0.8 * std::cos(towards), fy = 0.8 * std::sin(towards), fz = 0.6;
      const double apart = std::acos(std::clamp(x * fx + y * fy + z * fz, -1.0, 1.0));
      reach += 1.6 * Bump(apart, 0, 0.28);
    }
    return {reach * x, reach * y, reach * z};
  });
}

std::vector<HardSurface> HardSurfaces() {
  return {{"deep_cup", DeepCup(60)},
          {"car_body", CarBody(80)},
          {"starfish", Starfish(36)},
          {"twisted_ribbon", TwistedRibbon(240)},
          {"dented_ribbon", DentedRibbon(300)},
          {"tee_body", TeeBody(52)},
          {"face", Face(56)},
          {"paw", Paw(48)}};
}

std::vector<HardSurface> LargeHardSurfaces() {
  return {{"car_body_30k", CarBody(260)}, {"face_17k", Face(130)}, {"paw_20k", Paw(140)}};
}

}  // namespace arap::testing
