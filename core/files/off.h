// OFF (.off): the surface of a text.
#pragma once

#include <string_view>

#include "arap/base/result.h"
#include "core/files/surface_file.h"

namespace arap {

// The surface of an OFF text. `name` is what messages call the file.
//
// Read are: any line ends, a byte order mark, comments; the keyword in any case, with C, N or ST
// before it, glued to the counts or missing; two counts or three; polygons. Each vertex and each
// face has a line of its own, with colours and the like behind, which are passed over; or there are
// no such extras, and the lines are cut anywhere.
//
// kInvalidOption with the place and the word for anything that is no finite number or no index of a
// vertex, for counts that are more or less than the text holds, for faces of fewer than three
// corners, and for the variants with other dimensions and in binary. The memory is bounded by the
// text, whatever it claims.
Result<SurfaceFile> ParseOff(std::string_view text, const std::string& name);

}  // namespace arap
