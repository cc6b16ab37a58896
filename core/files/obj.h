// Wavefront OBJ (.obj): the surface of a text, and the text of a surface.
#pragma once

#include <span>
#include <string>

#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/files/surface_file.h"

namespace arap {

// The surface of an OBJ text. `name` is what messages call the file.
//
// Read are: any line ends, a byte order mark, comments, joined lines; v with two numbers (z is 0),
// three, four (a weight, told when it is not 1) and a colour of three or four numbers behind; every
// form of f, indices that count back, faces before their vertices, polygons; objects and groups.
// Vertices keep their order, also those that no face uses. Texture coordinates, normals, lines and
// materials do not matter here and stay in the text. Unknown statements are counted in a warning.
//
// kInvalidOption with the place and the word for anything that is no finite number or no index of a
// vertex, for faces of fewer than three corners, and for a text without faces. The memory is
// bounded by the text.
Result<SurfaceFile> ParseObj(std::string text, const std::string& name);

// The text of an OBJ file. Numbers are the shortest that read back exactly; z is 0 for a mesh of
// the plane.
std::string FormatObj(const PlanarMesh& mesh);
std::string FormatObj(const SurfaceMesh& mesh);
// With the faces and the objects that a file of any format has.
std::string FormatObj(const SurfaceFile& file);
// With a layout: a vt for each flat position in `uv` (#U), and `corner_uv` (#F) says which of them
// each corner has.
std::string FormatObj(const SurfaceMesh& mesh, std::span<const Complex> uv,
                      std::span<const Triangle> corner_uv);

}  // namespace arap
