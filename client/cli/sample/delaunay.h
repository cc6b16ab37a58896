// Delaunay triangulation of points.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/cli/sample/point.h"

namespace arap::cli {

// The triangles, counter-clockwise. The points must be distinct; there may be fewer than three.
std::vector<std::array<std::uint32_t, 3>> Delaunay(std::span<const Point> points);

}  // namespace arap::cli
