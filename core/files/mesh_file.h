// Triangle meshes in files: OBJ and OFF, by the ending of the name.
#pragma once

#include <string>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

// Faults name the file: kNotFound (it cannot be opened) or kInvalidOption (unknown ending, or what
// obj.h and off.h refuse).
Result<SurfaceMesh> ReadSurfaceMesh(const std::string& path);
// The same for a mesh in the plane: all z must be equal, and are dropped.
Result<PlanarMesh> ReadPlanarMesh(const std::string& path);

}  // namespace arap
