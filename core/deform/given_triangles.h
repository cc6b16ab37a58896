// Given triangles: places in the triangles that the client sent, where repairs have made others of them.
#pragma once

#include <array>
#include <cstdint>

#include "core/deform/registered_parts.h"
#include "core/mesh/locate.h"

namespace arap {

// Where a point of a given triangle is in the registered mesh, in the order of the registered triangle.
// One that collapsed is where its heaviest corner is; kNone when that is in no triangle. O(#F) for such,
// else O(log #F).
Located FromGiven(const RegisteredMeshParts& mesh, std::uint32_t given,
                  const std::array<double, 3>& barycentric);

// A point of a registered triangle as one of the given triangle that it belongs to, in the order in which
// that was sent.
Located ToGiven(const RegisteredMeshParts& mesh, const Located& place);

}  // namespace arap
