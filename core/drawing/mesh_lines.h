// A mesh as a few long lines, so that a picture of it is small.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// Vertex indices along each line. The same lines serve every frame of an animation.
using Lines = std::vector<std::vector<std::uint32_t>>;

// The closed boundary curves; a curve does not repeat its first vertex.
Lines BoundaryLines(std::span<const Triangle> triangles);
// Open lines that together draw every edge inside the mesh once.
Lines InnerLines(std::span<const Triangle> triangles);

}  // namespace arap
