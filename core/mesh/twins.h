// Twins: vertices that lie where another one lies.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// For each of `ids` (ascending, vertices of `points`) the lowest one within `tolerance` of those that
// stand for themselves, itself when there is none. So nothing drifts along a chain of near places: each
// vertex is at most `tolerance` away from its first, and those that stand for themselves are farther
// apart. With a tolerance of 0 equal places are one. Coordinates and their distances must be finite.
//
// A grid of cells that are sorted: O(n log n), 40 bytes for each id. The result follows from the numbers
// alone.
std::vector<std::uint32_t> FirstTwins(std::span<const Point3> points,
                                      std::span<const std::uint32_t> ids, double tolerance);

}  // namespace arap
