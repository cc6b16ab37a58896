// STL (.stl): the surface of a text or of the binary form.
#pragma once

#include <string>
#include <string_view>

#include "arap/base/result.h"
#include "core/files/surface_file.h"

namespace arap {

// Whether the bytes have exactly the length of a binary STL file with as many triangles as they say.
bool IsBinaryStl(std::string_view bytes);

// The surface of an STL file. `name` is what messages call it. What the length shows to be binary is
// read so, whatever its first bytes are: many such files begin with "solid". Normals, attributes
// and colours are passed over. A text may have several solids, which become objects.
//
// In STL every triangle has corners of its own. Those with equal coordinates become one vertex, in
// the order in which the file has them first, and a warning says so. Triangles with two equal
// corners cover nothing and are left out, with a warning too.
//
// kInvalidOption with the line and the word, or the byte, for anything that is no finite number, for
// text out of place, for files that end early or go on behind what they claim to hold, and for those
// without triangles. The memory is bounded by the file. O(n log n).
Result<SurfaceFile> ParseStl(std::string_view bytes, const std::string& name);

}  // namespace arap
