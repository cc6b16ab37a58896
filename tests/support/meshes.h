// Planar meshes made in code. All triangles are counter-clockwise; the same arguments give the same
// mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "arap/model/mesh.h"

namespace arap::testing {

// nx × ny cells of two triangles over [0, width] × [0, height]; (nx+1)(ny+1) vertices, row by row
// from below, left to right. All diagonals alike.
PlanarMesh Grid(std::size_t nx, std::size_t ny, double width, double height);

// nx × ny unit cells; every vertex, on the boundary too, moved by at most `jitter` in x and in y;
// the diagonals are random. 0 <= jitter < 0.25 keeps every triangle upright.
PlanarMesh JitteredGrid(std::size_t nx, std::size_t ny, std::uint64_t seed, double jitter = 0.2);

// A ring around the origin: `rings` × `sectors` cells between the two radii; two boundary loops.
PlanarMesh Annulus(std::size_t rings, std::size_t sectors, double inner, double outer);

// JitteredGrid twice, the second to the right of the first; vertices of the first come first.
PlanarMesh TwoComponents(std::size_t nx, std::size_t ny, std::uint64_t seed);

// n triangles in a zigzag of height 1 along the x axis: n + 2 vertices, none of them interior.
PlanarMesh Strip(std::size_t n);

PlanarMesh SingleTriangle();
// The unit square: two triangles, the diagonal from (0, 0).
PlanarMesh Square();

// The mesh with its vertices and triangles in random order and every triangle started at a random
// corner.
struct RenumberedMesh {
  PlanarMesh mesh;
  std::vector<std::uint32_t> new_vertex;    // by old index
  std::vector<std::uint32_t> new_triangle;  // by old index
};
RenumberedMesh Renumbered(const PlanarMesh& mesh, std::uint64_t seed);

// The mesh moved by z ↦ factor·z + shift.
PlanarMesh Moved(const PlanarMesh& mesh, Complex factor, Complex shift);

// Every vertex index of a cell-by-cell grid, and its triangles: what the generators share. Vertex
// (i, j) is j·(nx+1) + i; `flip(i, j)` chooses the diagonal of a cell.
template <class FlipDiagonal>
std::vector<Triangle> GridTriangles(std::size_t nx, std::size_t ny, FlipDiagonal flip) {
  std::vector<Triangle> triangles;
  triangles.reserve(2 * nx * ny);
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (nx + 1) + i);
      const std::uint32_t b = a + 1;
      const auto d = static_cast<std::uint32_t>(a + nx + 1);
      const std::uint32_t c = d + 1;
      if (flip(i, j)) {
        triangles.push_back({a, b, d});
        triangles.push_back({b, c, d});
      } else {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      }
    }
  }
  return triangles;
}

}  // namespace arap::testing
