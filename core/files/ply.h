// PLY (.ply): the surface of a text or of either binary form.
#pragma once

#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "core/files/surface_file.h"

namespace arap {

// The surface of a PLY file. `name` is what messages call it.
//
// Read are x, y and z of the vertices, of any type, and the corners of the faces, of any whole type;
// the elements in any order; polygons. In a text every element has a line of its own. All other
// properties and elements are passed over, and a warning names them.
//
// kInvalidOption with the line and the word, or the byte, for anything that is no finite number or no
// index of a vertex, for counts that are more or less than the file holds, for faces of fewer than
// three corners, for triangle strips, and for a file without faces. The memory is bounded by the
// file, whatever it claims.
Result<SurfaceFile> ParsePly(std::string_view bytes, const std::string& name);

}  // namespace arap
