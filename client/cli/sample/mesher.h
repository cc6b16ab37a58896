// Triangulates the inside of a field.
#pragma once

#include "arap/model/mesh.h"
#include "client/cli/sample/field.h"

namespace arap::cli {

// Well-shaped counter-clockwise triangles with edges about `edge` long, without loose vertices; the
// vertices of the outline come first. `start` is a point near the outline.
PlanarMesh MeshField(const Field& field, Point start, double edge);

}  // namespace arap::cli
