// The sample meshes of the plane, each with a track that moves it.
#pragma once

#include <cstddef>

#include "arap/model/mesh.h"
#include "core/files/track.h"

namespace arap::cli {

inline constexpr double kCharacterEdge = 4;

// A teddy bear, 200 units tall. `edge` is the length of its edges, 1 to 8.
PlanarMesh MakeCharacter(double edge);
// It waves, in 120 frames that loop: handles at the hands, the feet and the head. `mesh` is a
// character.
Track MakeCharacterTrack(const PlanarMesh& mesh);

// A plain rectangle of squares, each cut in two, with alternating diagonals: columns × rows
// vertices, at least 2 × 2, one unit apart, lower left corner at the origin.
PlanarMesh MakeGrid(std::size_t columns, std::size_t rows);
// 60 frames that loop: four handles near the corners; the right two turn about the middle.
Track MakeGridTrack(const PlanarMesh& mesh, std::size_t columns, std::size_t rows);

}  // namespace arap::cli
