// The sample face: a bumpy cap that no map to the plane keeps the lengths of, in centimetres.
#pragma once

#include "arap/model/mesh.h"

namespace arap::cli {

inline constexpr double kFaceEdge = 0.75;

// One disk that looks along z with y up, about 13 wide, 18 high and 10 deep. `edge` is about the
// length of its edges, 0.2 to 2.
SurfaceMesh MakeFace(double edge);

}  // namespace arap::cli
