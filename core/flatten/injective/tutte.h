// Tutte's embedding: the start that no surface refuses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

enum class TutteWeights {
  kUniform,
  kCotangent,  // raised to a small positive number where it is not
};

// Lays a connected surface of genus 0 on the unit disk: the first of its boundary `loops` (ordered,
// as the triangles run) counter-clockwise on the circle by arc length, every other vertex at the
// weighted mean of its neighbours, every further loop filled with a fan. In exact arithmetic all
// triangles are upright [Tutte 1963, Floater 1997]; in doubles a deep surface may crowd. Cotangents
// of triangles in `left_out` (#F or empty) are not asked for. Returns #V places; unreferenced
// vertices come to 0. Fault: kNumerical.
Result<std::vector<Complex>> TutteEmbedding(const SurfaceMesh& mesh,
                                            std::span<const std::vector<std::uint32_t>> loops,
                                            TutteWeights weights,
                                            const std::vector<bool>& left_out = {});

}  // namespace arap
