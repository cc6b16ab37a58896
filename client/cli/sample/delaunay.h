// Delaunay triangulation of points.
#pragma once

#include <span>
#include <vector>

#include "arap/model/mesh.h"
#include "client/cli/sample/point.h"

namespace arap::cli {

// The triangles, counter-clockwise. The points must be distinct; there may be fewer than three.
std::vector<Triangle> Delaunay(std::span<const Point> points);

}  // namespace arap::cli
