// Depth order: which parts of a shape lie in front of which, as the depths of its handles say
// [algorithm §4].
#pragma once

#include <cstdint>
#include <vector>

#include "arap/core/compiled_handles.h"

namespace arap {

// The depth of every vertex (#V), higher is nearer: those of the handles on its component added up,
// each fading linearly to 0 over its falloff at rest. Empty when no handle has a depth. O(#V) per
// handle with a depth.
std::vector<double> VertexDepths(const CompiledHandles& handles);

// The triangles (#F) from back to front, by the mean depth of their corners; those at one depth in
// their own order. Empty when no handle has a depth.
std::vector<std::uint32_t> DrawOrder(const CompiledHandles& handles);

}  // namespace arap
