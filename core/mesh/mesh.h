// The two meshes that everything else works on. Plain data, validated by validation.h.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace arap {

// A point of the plane; x + iy, so that a similarity is one multiplication [algorithm §2].
using Complex = std::complex<double>;
// Three vertex indices, counter-clockwise.
using Triangle = std::array<std::uint32_t, 3>;

// #V points of the plane, #F triangles.
struct PlanarMesh {
  std::vector<Complex> vertices;
  std::vector<Triangle> triangles;
};

// #V points of space, #F triangles.
struct SurfaceMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> triangles;
};

}  // namespace arap
