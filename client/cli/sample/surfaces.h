// The sample surfaces, in space and in centimetres: a garment that is nearly developable, and a
// face that no map to the plane keeps the lengths of.
#pragma once

#include "arap/model/mesh.h"

namespace arap::cli {

inline constexpr double kGarmentEdge = 2.5;

// The front panel of a skirt as it hangs: one disk. Nearly developable: round the hip, with folds
// that deepen towards the hem. `edge` is the length of its edges, 0.5 to 8.
SurfaceMesh MakeGarment(double edge);

inline constexpr double kFaceEdge = 0.75;

// A bumpy cap: one disk that looks along z with y up, about 13 wide, 18 high and 10 deep. `edge` is
// about the length of its edges, 0.2 to 2.
SurfaceMesh MakeFace(double edge);

}  // namespace arap::cli
