// Flips that are few and far between are pushed out where they are; the rest of the layout is held.
#pragma once

#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/flatten/injective/newton.h"

namespace arap {

// Frees a few rings of vertices around the triangles of `uv` (#V, meets the hard `pins`) that are
// not upright, and untangles the triangles around these, ever wider ones until all are upright:
// true. False, with `uv` as it was, when they are not, when there is no flip, or when a quarter of
// the surface would not do. Triangles in the mask `left_out` (#F or empty) do not count. Costs some
// of Newton's steps on the patches alone, which are added to `iterations`. Faults: kNumerical,
// kOutOfMemory, and what `cancel` answers.
Result<bool> MendPatches(const SurfaceMesh& mesh, std::span<const LayoutPin> pins,
                         const std::vector<bool>& left_out, const CancelToken& cancel,
                         std::vector<Complex>& uv, int& iterations);

}  // namespace arap
