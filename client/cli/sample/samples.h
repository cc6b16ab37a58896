// The sample meshes: those of the plane, each with a track that moves it; and the surfaces, in space
// and in centimetres: a garment that is nearly developable, and a face that no map to the plane
// keeps the lengths of.
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

inline constexpr double kGarmentEdge = 2.5;

// The front panel of a skirt as it hangs: one disk. Nearly developable: round the hip, with folds
// that deepen towards the hem. `edge` is the length of its edges, 0.5 to 8.
SurfaceMesh MakeGarment(double edge);

inline constexpr double kFaceEdge = 0.75;

// A bumpy cap: one disk that looks along z with y up, about 13 wide, 18 high and 10 deep. `edge` is
// about the length of its edges, 0.2 to 2.
SurfaceMesh MakeFace(double edge);

}  // namespace arap::cli
