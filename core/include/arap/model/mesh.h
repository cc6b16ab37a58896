// Meshes as everybody gives and takes them, and what was noticed about them. Plain values; nothing
// is checked here; registering or flattening a mesh does that.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace arap {

// A point of the plane; x + iy, so that a similarity is one multiplication [algorithm §1].
using Complex = std::complex<double>;
// A point of space.
using Point3 = std::array<double, 3>;
// Three vertex indices; counter-clockwise once a planar mesh is validated.
using Triangle = std::array<std::uint32_t, 3>;

// #V points of the plane in any unit, #F triangles.
struct PlanarMesh {
  std::vector<Complex> vertices;
  std::vector<Triangle> triangles;

  bool operator==(const PlanarMesh&) const = default;
};

// #V points of space in any unit, #F triangles.
struct SurfaceMesh {
  std::vector<Point3> vertices;
  std::vector<Triangle> triangles;

  bool operator==(const SurfaceMesh&) const = default;
};

struct MeshLimits {
  std::size_t max_vertices = 1'000'000;
  std::size_t max_triangles = 2'000'000;

  bool operator==(const MeshLimits&) const = default;
};

// Something that was repaired or ignored; never an error.
struct Warning {
  std::string kind;       // for programs: "reversed_triangles", "unreferenced_vertices", …
  std::size_t count = 0;  // how many elements it concerns
  std::vector<std::uint32_t> elements;  // the first few of them
  std::string message;                  // a sentence

  bool operator==(const Warning&) const = default;
};

// What registration found out about a planar mesh.
struct RegistrationReport {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t edges = 0;
  std::size_t components = 0;  // connected through vertices; unreferenced vertices are none
  std::size_t boundary_loops = 0;
  double area = 0;      // squared units of the mesh
  double diagonal = 0;  // of the bounding box of the referenced vertices, units of the mesh
  std::size_t clamped_weights = 0;  // edges whose cotangent weight was raised to kMinCotangent
  std::vector<Warning> warnings;
  std::size_t bytes = 0;  // held by factors and tables

  bool operator==(const RegistrationReport&) const = default;
};

}  // namespace arap
