// What the pieces of a layout are called.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/drawing.h"
#include "arap/model/flatten.h"

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

}  // namespace arap
