// Triangle meshes in files: OBJ and OFF, by the ending of the name.
#pragma once

#include <span>
#include <string>

#include "arap/base/result.h"
#include "arap/client/mesh.h"

namespace arap::cli {

// Vertices keep their order, also those that no triangle uses; texture coordinates and normals are
// passed over. Faults name the file: kNotFound (cannot be opened) or kInvalidOption (unknown
// ending, not in the format, a face that is no triangle, an index that is not there).
Result<client::SurfaceMesh> ReadSurfaceMesh(const std::string& path);
// The same for a mesh in the plane: all z must be equal, and are dropped.
Result<client::PlanarMesh> ReadPlanarMesh(const std::string& path);

// OBJ texts. With flat positions `uv` (u v u v…) each corner gets its own vt from `corner_uv`.
std::string FormatObj(const client::PlanarMesh& mesh);
std::string FormatObj(const client::SurfaceMesh& mesh);
std::string FormatObj(const client::SurfaceMesh& mesh, std::span<const double> uv,
                      std::span<const std::uint32_t> corner_uv);

}  // namespace arap::cli
