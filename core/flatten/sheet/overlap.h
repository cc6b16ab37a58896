// Does a layout overlap itself? Asked of its boundary, within one chart and between charts.
//
// A layout without flipped triangles can still run over itself at its outline, like a spiral with
// too many turns; and a chart can lie on another. The first shows as boundary segments that cross,
// the second either so or as a whole boundary loop inside a chart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/cut/pieces.h"
#include "core/mesh/topology.h"

namespace arap {

// Charts that only touch do not overlap: boundaries are compared after every one was drawn in by 1
// to 2 times this fraction of the layout's diagonal. So the two sides of a cut that were laid next
// to each other are apart even when rounding makes them cross; in turn, a strip narrower than that
// may count as overlapping itself.
inline constexpr double kTouching = 1e-7;

// Counting ends here. A layout with so many crossings needs no better number.
inline constexpr std::size_t kMaxCrossings = 100'000;

struct Overlap {
  // Pairs of boundary segments that cross, at most kMaxCrossings. Segments with a common vertex are
  // never counted.
  std::size_t crossings = 0;
  // The first pair in the order of the loops: from, to, from, to; kNone when there is none.
  std::array<std::uint32_t, 4> first_crossing{kNone, kNone, kNone, kNone};
  // Loops that lie inside another chart, or wrongly in their own: an outline inside of it, a hole
  // outside or turned inside out (as happens when a ring is laid over its own hole).
  std::size_t misplaced_loops = 0;
  std::uint32_t first_misplaced = kNone;  // index of a loop

  bool any() const { return crossings > 0 || misplaced_loops > 0; }
};

// Loops have the surface on the left: outlines run counter-clockwise, holes clockwise; their
// component is the chart. `uv` must be finite. Loops of fewer than three vertices are left out. For n
// boundary segments O(n log n), and what pairs of segments and of loops have bounding boxes that
// meet. Faults: what `cancel` answers on the way. Deterministic, thread-safe.
Result<Overlap> FindOverlap(std::span<const Complex> uv, std::span<const BoundaryLoop> loops,
                            const CancelToken& cancel = {});

}  // namespace arap
