// Pose: where a deformed shape has a point of the rest mesh.
#pragma once

#include <span>

#include "arap/model/handle.h"
#include "arap/model/mesh.h"

namespace arap::app {

// The target that leaves the shape as it is: the handle's rest point carried along by `positions`
// (#V), and the rotation and scale of its triangle. Where triangles overlap at rest, the handle's
// own anchor decides, for anchors by point the lowest index. O(#F) for anchors by vertex and by
// point.
Target PoseOf(const PlanarMesh& mesh, const PlacedHandle& handle,
              std::span<const Complex> positions);

}  // namespace arap::app
