// What the flattening comparison works on.
#pragma once

#include <cstddef>

#include "arap/model/mesh.h"

namespace arap::bench {

// A disk-like piece of the unit sphere, 70° from pole to rim, with smooth bumps; far from
// developable, seen from above it is a height field. About that many triangles, irregular: every
// vertex is off its place by up to a quarter of an edge. The same number gives the same surface.
SurfaceMesh BumpyCap(std::size_t triangles);

}  // namespace arap::bench
