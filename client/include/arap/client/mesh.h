// Meshes as a caller gives them, and what the server says about them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "arap/client/energy.h"

namespace arap::client {

// Triangles in the plane. Nothing is checked here: the server checks, and names what is wrong.
struct PlanarMesh {
  std::vector<double> vertices;          // x y x y…, length 2·#V, any unit, finite
  std::vector<std::uint32_t> triangles;  // i j k i j k…, length 3·#F, each below #V

  std::size_t vertex_count() const { return vertices.size() / 2; }
  std::size_t triangle_count() const { return triangles.size() / 3; }
};

// Triangles in space.
struct SurfaceMesh {
  std::vector<double> vertices;          // x y z x y z…, length 3·#V, any unit, finite
  std::vector<std::uint32_t> triangles;  // i j k i j k…, length 3·#F, each below #V

  std::size_t vertex_count() const { return vertices.size() / 3; }
  std::size_t triangle_count() const { return triangles.size() / 3; }
};

// Something that the server repaired or ignored; never an error.
struct Warning {
  std::string kind;                     // for programs, for example "unreferenced_vertices"
  std::uint64_t count = 0;              // how many elements it concerns
  std::vector<std::uint32_t> elements;  // the first few of them
  std::string message;                  // a sentence
};

// A registered mesh.
struct MeshInfo {
  std::string id;
  std::string
      content_hash;  // SHA-256 of the mesh and its options; equal meshes share their factors
  std::uint64_t vertex_count = 0;
  std::uint64_t triangle_count = 0;
  std::uint64_t edge_count = 0;
  std::uint64_t component_count = 0;      // connected components that have triangles
  std::uint64_t boundary_loop_count = 0;  // closed boundary curves
  double area = 0;                        // squared units of the mesh
  double diagonal = 0;                    // of the bounding box, units of the mesh
  std::vector<Warning> warnings;
  std::uint64_t bytes = 0;  // held by the factors and tables
  EnergyOptions energy;     // the options in force
};

// The answer to a registration.
struct RegisteredMesh {
  MeshInfo mesh;
  bool shared = false;      // whether the factors were there already
  double queue_micros = 0;  // time spent waiting for a worker
  double solve_micros = 0;  // time spent computing
};

}  // namespace arap::client
