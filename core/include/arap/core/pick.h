// What lies in front of what in a deformed shape, as the depths of its handles say [algorithm §4],
// and picking: the inverse map, from a point of the shape to the mesh at rest.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/core/compiled_handles.h"
#include "arap/model/deform.h"

namespace arap {

// The depth of every vertex (#V), higher is nearer: those of the handles on its component added up,
// each fading linearly to 0 over its falloff at rest. Empty when no handle has a depth. Found when
// the handles are compiled; lives as long as they do.
std::span<const double> VertexDepths(const CompiledHandles& handles);

// The triangles (#F) from back to front, by the mean depth of their corners; those at one depth in
// their own order. Empty when no handle has a depth. O(#F log #F).
std::vector<std::uint32_t> DrawOrder(const CompiledHandles& handles);

// The triangles on which handles sit at rest: for an anchor by vertex the lowest that has it, for one
// by point the lowest that holds its rest; nothing for a vertex without a triangle. O(#F) for all
// together, once for anchors by vertex and once for those by point, and O(log #F) for each.
std::vector<std::optional<std::uint32_t>> TrianglesUnder(const RegisteredMesh& mesh,
                                                         std::span<const PlacedHandle> handles);

// Where the points are on the mesh at rest: for each the triangle of `positions` (#V, units of the
// mesh, as Deformer::positions() gives them) that holds it, its edges included, and where the point
// was at rest; nothing when none does. Where triangles overlap the one with the highest depth at the
// point wins, then the lowest index. O(#F) for all points together and O(log #F) for each where few
// triangles lie over one another. Fault: what `cancel` answers between points.
Result<std::vector<std::optional<Pick>>> FindPicks(const CompiledHandles& handles,
                                                   std::span<const Complex> positions,
                                                   std::span<const Complex> points,
                                                   const CancelToken& cancel = {});

}  // namespace arap
