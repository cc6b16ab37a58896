// Handles for sample tracks.
#pragma once

#include <string>

#include "arap/model/mesh.h"
#include "client/cli/sample/field.h"
#include "core/files/track.h"

namespace arap::cli {

// Adds a handle that holds `mesh` at `rest`, a point inside it.
void AddHandle(const PlanarMesh& mesh, const std::string& name, Point rest, Track& track);

}  // namespace arap::cli
