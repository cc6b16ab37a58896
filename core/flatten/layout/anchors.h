// Anchors: the two vertices that fix the free similarity of the first step.
#pragma once

#include <array>
#include <cstdint>

#include "core/flatten/layout/held.h"
#include "core/flatten/surface_chart.h"

namespace arap {

// Ends of the edge whose middle is nearest to the area centroid; of the lowest such edge. Edges
// without length do not count [II09 §7 "an edge at the center of the mesh"].
std::array<std::uint32_t, 2> CentreEdge(const SurfaceChart& chart);

// The boundary vertex farthest from the centroid and the one farthest from that. Never the
// quadratic search for the farthest pair.
std::array<std::uint32_t, 2> FarBoundaryPair(const SurfaceChart& chart);

// The first at 0, the second at their distance in space on the real axis.
Held HoldAtDistance(const SurfaceChart& chart, const std::array<std::uint32_t, 2>& anchors);

}  // namespace arap
