// Picking: the inverse map, from a point of the deformed shape to the mesh at rest.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "arap/core/compiled_handles.h"
#include "arap/model/deform.h"

namespace arap {

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
