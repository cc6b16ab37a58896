// OFF: the header, the counts, a line per vertex, a line per face.
#pragma once

#include <string>

#include "arap/base/result.h"
#include "arap/model/mesh.h"

namespace arap {

// Vertices keep their order, also those that no triangle uses. kInvalidOption when the text is not
// in the format, a face is no triangle or an index is not there.
Result<SurfaceMesh> ParseOff(std::string text);

}  // namespace arap
