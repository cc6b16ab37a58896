// A mesh as a few long lines, so that a picture of it is small.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/drawing/svg/view.h"

namespace arap::cli {

// Vertex indices along each line. The same lines serve every frame of an animation.
using Lines = std::vector<std::vector<std::uint32_t>>;

// The closed boundary curves; a curve does not repeat its first vertex.
Lines BoundaryLines(std::span<const std::uint32_t> triangles);
// Open lines that together draw every edge inside the mesh once.
Lines InnerLines(std::span<const std::uint32_t> triangles);

// The value of the attribute `d`. Coordinates are whole picture units, relative to the point
// before.
std::string PathData(const Lines& lines, bool closed, std::span<const double> positions,
                     const View& view);

}  // namespace arap::cli
