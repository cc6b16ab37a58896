// Wavefront OBJ: triangles, and where each of their corners lies on a flat layout.
#pragma once

#include <span>
#include <string>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

// Vertices keep their order, also those that no triangle uses; texture coordinates and normals are
// passed over. kInvalidOption when the text is not in the format, a face is no triangle or an index
// is not there.
Result<SurfaceMesh> ParseObj(std::string text);

// Numbers are the shortest that read back exactly; z is 0 for a mesh of the plane.
std::string FormatObj(const PlanarMesh& mesh);
std::string FormatObj(const SurfaceMesh& mesh);
// With the layout: a vt for each flat position in `uv` (#U), and `corner_uv` (#F) says which of
// them each corner has.
std::string FormatObj(const SurfaceMesh& mesh, std::span<const Complex> uv,
                      std::span<const Triangle> corner_uv);

}  // namespace arap
