// What lies in front of what in a deformed shape, as the depths of its handles say [algorithm §4],
// and picking: the inverse map, from a point of the shape to the mesh at rest.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "arap/core/compiled_handles.h"
#include "arap/model/deform.h"

namespace arap {

// The depth of every vertex (#V), higher is nearer: those of the handles on its component added up,
// each fading linearly to 0 over its falloff at rest. Empty when no handle has a depth. O(#V) per
// handle with a depth.
std::vector<double> VertexDepths(const CompiledHandles& handles);

// The triangles (#F) from back to front, by the mean depth of their corners; those at one depth in
// their own order. Empty when no handle has a depth.
std::vector<std::uint32_t> DrawOrder(const CompiledHandles& handles);

// Immutable, shared by threads. Keeps the handle set alive.
class Picker {
 public:
  // O(#V) per handle with a depth.
  explicit Picker(std::shared_ptr<const CompiledHandles> handles);

  // The triangle of `positions` (#V, units of the mesh, as Deformer::positions() gives them) that
  // holds `point`, its edges included, and where that point was at rest; nothing when none does.
  // Where triangles overlap the one with the highest depth at the point wins, then the lowest
  // index. O(#F).
  std::optional<Pick> Find(std::span<const Complex> positions, Complex point) const;

 private:
  std::shared_ptr<const CompiledHandles> handles_;
  std::vector<double> depths_;  // #V, or empty
};

}  // namespace arap
