// Plane fit: a mesh of the plane that was stored in space, in whichever plane it lies.
#pragma once

#include <vector>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

// How far from its plane a mesh may be, as a part of the diagonal of its bounding box.
inline constexpr double kPlaneTolerance = 1e-6;

// A mesh in coordinates of its plane, and what there is to say about that.
struct PlaneFit {
  PlanarMesh mesh;             // vertices and triangles in the order of the input
  std::vector<Warning> notes;  // "plane": it is another one than that of x and y, or not exact
};

// Two coordinates as they are where all vertices lie, within kPlaneTolerance, in a plane of the axes:
// x and y, else x and z, else y and z. Otherwise true lengths in the plane that fits best (least squares
// over the vertices): its first axis is the one of x, y, z that is nearest to the plane and earliest,
// laid into it, and the second lies across it on the side of the other one. Places are counted from
// where the origin falls. O(#V); the same on every machine up to rounding.
//
// kInvalidOption: the mesh is in no plane; names the vertex that is farthest off, from 0.
Result<PlaneFit> FitPlane(SurfaceMesh mesh);

}  // namespace arap
