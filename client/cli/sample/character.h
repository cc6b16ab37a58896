// The sample character: a teddy bear, 200 units tall, that waves.
#pragma once

#include "arap/model/mesh.h"
#include "core/files/track.h"

namespace arap::cli {

inline constexpr double kCharacterEdge = 4;

// `edge` is the length of its edges, 1 to 8.
PlanarMesh MakeCharacter(double edge);

// 120 frames that loop: handles at the hands, the feet and the head. `mesh` is a character.
Track MakeCharacterTrack(const PlanarMesh& mesh);

}  // namespace arap::cli
