// The sample grid: a plain rectangle of squares, each cut in two.
#pragma once

#include <cstddef>

#include "arap/model/mesh.h"
#include "core/files/track.h"

namespace arap::cli {

// columns × rows vertices, at least 2 × 2, one unit apart, lower left corner at the origin. The
// diagonals alternate.
PlanarMesh MakeGrid(std::size_t columns, std::size_t rows);

// 60 frames that loop: four handles near the corners; the right two turn about the middle.
Track MakeGridTrack(const PlanarMesh& mesh, std::size_t columns, std::size_t rows);

}  // namespace arap::cli
