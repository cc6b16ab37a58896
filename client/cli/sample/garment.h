// The sample garment: the front panel of a skirt as it hangs, in centimetres.
#pragma once

#include "arap/model/mesh.h"

namespace arap::cli {

inline constexpr double kGarmentEdge = 2.5;

// One disk. Nearly developable: round the hip, with folds that deepen towards the hem. `edge` is
// the length of its edges, 0.5 to 8.
SurfaceMesh MakeGarment(double edge);

}  // namespace arap::cli
