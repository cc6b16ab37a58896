#include "tests/support/meshes.h"

#include <algorithm>
#include <cassert>
#include <numbers>
#include <numeric>

#include "tests/support/random.h"

namespace arap::testing {

PlanarMesh Grid(std::size_t nx, std::size_t ny, double width, double height) {
  PlanarMesh mesh;
  for (std::size_t j = 0; j <= ny; ++j) {
    for (std::size_t i = 0; i <= nx; ++i) {
      mesh.vertices.emplace_back(width * static_cast<double>(i) / static_cast<double>(nx),
                                 height * static_cast<double>(j) / static_cast<double>(ny));
    }
  }
  mesh.triangles = GridTriangles(nx, ny, [](std::size_t, std::size_t) { return false; });
  return mesh;
}

PlanarMesh JitteredGrid(std::size_t nx, std::size_t ny, std::uint64_t seed, double jitter) {
  // A corner triangle with legs 1 keeps its area above (1−2j)² − (2j)² = 1 − 4j.
  assert(jitter >= 0 && jitter < 0.25);
  Random random(seed);
  PlanarMesh mesh = Grid(nx, ny, static_cast<double>(nx), static_cast<double>(ny));
  for (Complex& v : mesh.vertices) {
    const double dx = random.Uniform(-jitter, jitter);
    const double dy = random.Uniform(-jitter, jitter);
    v += Complex(dx, dy);
  }
  mesh.triangles = GridTriangles(nx, ny, [&](std::size_t, std::size_t) { return random.Coin(); });
  return mesh;
}

PlanarMesh Annulus(std::size_t rings, std::size_t sectors, double inner, double outer) {
  PlanarMesh mesh;
  for (std::size_t r = 0; r <= rings; ++r) {
    const double radius =
        inner + (outer - inner) * static_cast<double>(r) / static_cast<double>(rings);
    for (std::size_t s = 0; s < sectors; ++s) {
      const double angle =
          2 * std::numbers::pi * static_cast<double>(s) / static_cast<double>(sectors);
      mesh.vertices.push_back(std::polar(radius, angle));
    }
  }
  const auto index = [&](std::size_t r, std::size_t s) {
    return static_cast<std::uint32_t>(r * sectors + s % sectors);
  };
  for (std::size_t r = 0; r < rings; ++r) {
    for (std::size_t s = 0; s < sectors; ++s) {
      mesh.triangles.push_back({index(r, s), index(r + 1, s), index(r + 1, s + 1)});
      mesh.triangles.push_back({index(r, s), index(r + 1, s + 1), index(r, s + 1)});
    }
  }
  return mesh;
}

PlanarMesh TwoComponents(std::size_t nx, std::size_t ny, std::uint64_t seed) {
  PlanarMesh mesh = JitteredGrid(nx, ny, seed);
  const PlanarMesh second =
      Moved(JitteredGrid(nx, ny, seed + 1), 1.0, Complex(static_cast<double>(nx) + 2, 0.5));
  const auto offset = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), second.vertices.begin(), second.vertices.end());
  for (const Triangle& t : second.triangles) {
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return mesh;
}

PlanarMesh Strip(std::size_t n) {
  PlanarMesh mesh;
  for (std::size_t i = 0; i < n + 2; ++i) {
    mesh.vertices.emplace_back(0.5 * static_cast<double>(i), static_cast<double>(i % 2));
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto a = static_cast<std::uint32_t>(i);
    if (i % 2 == 0) {
      mesh.triangles.push_back({a, a + 2, a + 1});
    } else {
      mesh.triangles.push_back({a, a + 1, a + 2});
    }
  }
  return mesh;
}

PlanarMesh Square() { return {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}}; }

PlanarMesh SingleTriangle() {
  return {{Complex(0, 0), Complex(2, 0.25), Complex(0.5, 1.5)}, {{0, 1, 2}}};
}

RenumberedMesh Renumbered(const PlanarMesh& mesh, std::uint64_t seed) {
  Random random(seed);
  RenumberedMesh result;
  result.new_vertex.resize(mesh.vertices.size());
  result.new_triangle.resize(mesh.triangles.size());
  std::iota(result.new_vertex.begin(), result.new_vertex.end(), 0U);
  std::iota(result.new_triangle.begin(), result.new_triangle.end(), 0U);
  random.Shuffle(result.new_vertex);
  random.Shuffle(result.new_triangle);
  result.mesh.vertices.resize(mesh.vertices.size());
  result.mesh.triangles.resize(mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    result.mesh.vertices[result.new_vertex[v]] = mesh.vertices[v];
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle corners = mesh.triangles[t];
    for (std::uint32_t& v : corners) v = result.new_vertex[v];
    std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(random.Below(3)),
                corners.end());
    result.mesh.triangles[result.new_triangle[t]] = corners;
  }
  return result;
}

PlanarMesh Moved(const PlanarMesh& mesh, Complex factor, Complex shift) {
  PlanarMesh moved = mesh;
  for (Complex& v : moved.vertices) v = factor * v + shift;
  return moved;
}

}  // namespace arap::testing
