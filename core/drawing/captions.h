// What is written on a drawing and below it: what the pieces are called, and what people are told
// of the layout.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/drawing.h"
#include "arap/model/flatten.h"
#include "core/drawing/pattern.h"

namespace arap {

// Bytes of the name of a piece; what is longer is cut and ends with three dots.
inline constexpr std::size_t kLongestPieceName = 64;

// Whether the parts come one after the other on a surface of so many triangles, kInvalidOption with
// the field "parts[i].first_triangle".
Status CheckParts(std::span<const NamedPart> parts, std::size_t triangles);

// By chart the name of the part that most of its triangles are of, of equal ones the first; empty
// where most are of none. Several pieces of one name are numbered from 1, passing over what another
// piece is called. Characters that are not seen or that turn writing are question marks. The parts
// are good (CheckParts); O(#F log of the parts).
std::vector<std::string> PieceNames(const Flattening& flat, std::span<const NamedPart> parts);

// A few lines: counts, distortion, refinements that reached their limit, cuts, the sizes of the
// pieces and of the sheet in millimetres. What goes under the colours of an SVG.
std::vector<std::string> Summary(const Flattening& flat, const Pattern& pattern);

// "unlikely_size": pieces shorter than 5 mm or longer than 10 m, which another unit would make
// likelier. `option` is what says the unit.
std::vector<Warning> SizeWarnings(const Pattern& pattern, std::string_view option);

}  // namespace arap
