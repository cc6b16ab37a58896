// Where in a mesh of the plane a point lies, in barycentric coordinates.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "arap/model/mesh.h"
#include "core/base/plane.h"
#include "core/mesh/topology.h"

namespace arap {

struct Located {
  std::uint32_t triangle = kNone;
  std::array<double, 3> barycentric{};
  double distance = 0;  // how far snapping moved it
};

// Barycentric coordinates of `p`; finite for non-degenerate triangles, negative outside.
std::array<double, 3> Barycentric(const std::array<Complex, 3>& corners, Complex p);

// How far outside a triangle a point may be and still count, relative to the triangle.
inline constexpr double kLocateTolerance = 1e-9;

// Where in the triangle `p` lies, its boundary included up to `tolerance`; nothing when it does not.
// Triangles of either orientation hold points; degenerate ones do not.
std::optional<Located> LocateIn(std::span<const Complex> vertices,
                                std::span<const Triangle> triangles, std::uint32_t triangle,
                                Complex p, double tolerance = kLocateTolerance);

// The lowest triangle that holds `p`. O(#F), without tables: about 0.1 ms at 20k triangles; for many
// points of one shape see triangle_boxes.h.
std::optional<Located> Locate(std::span<const Complex> vertices,
                              std::span<const Triangle> triangles, Complex p,
                              double tolerance = kLocateTolerance);

// The nearest point of the boundary to `p`. Needs at least one boundary edge.
Located NearestOnBoundary(std::span<const Complex> vertices, std::span<const Triangle> triangles,
                          const Topology& topology, Complex p);

}  // namespace arap
