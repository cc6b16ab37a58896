// Point location by search over all triangles: about 0.1 ms at 20k triangles, no tables to keep.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "arap/model/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

struct Located {
  std::uint32_t triangle = kNone;
  std::array<double, 3> barycentric{};
  Complex point;        // where it is, after snapping
  double distance = 0;  // how far snapping moved it
};

// Barycentric coordinates of `p`; finite for non-degenerate triangles, negative outside.
std::array<double, 3> Barycentric(const std::array<Complex, 3>& corners, Complex p);

// The lowest triangle that holds `p`, its boundary included up to `tolerance` (relative to the
// triangle). Triangles of either orientation count; degenerate ones do not.
std::optional<Located> Locate(std::span<const Complex> vertices,
                              std::span<const Triangle> triangles, Complex p,
                              double tolerance = 1e-9);

// The nearest point of the boundary to `p`. Needs at least one boundary edge.
Located NearestOnBoundary(std::span<const Complex> vertices, std::span<const Triangle> triangles,
                          const Topology& topology, Complex p);

}  // namespace arap
