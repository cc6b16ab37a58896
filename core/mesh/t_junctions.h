// T-junctions: vertices of the border that lie inside an edge of the border, so that what looks joined
// is not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/mesh/topology.h"

namespace arap {

struct TJunction {
  std::uint32_t side = 0;  // the border side, which runs past the vertex
  double at = 0;           // where along it, 0 to 1 from its lower to its higher vertex
  std::uint32_t vertex = 0;
};

struct TJunctions {
  std::vector<TJunction> found;  // by side, then along it
  // There was more than could be looked at: borders lie on one another again and again.
  bool cut_short = false;
};

// The vertices of border sides that are within `tolerance` of another border side and farther than that
// from its ends, where a border edge of the vertex runs along that side; a corner that only touches a
// side is none. `border` are the sides that are alone on their edge. Ends with `cut_short` after four
// junctions for each border side, or when the search looks at more than a fixed number of things for each.
// A tree of boxes: O(n log n) for n border sides that do not lie on one another. Fault: that of
// `cancel`.
Result<TJunctions> FindTJunctions(std::span<const Point3> points,
                                  std::span<const Triangle> triangles, std::span<const Side> border,
                                  double tolerance, const CancelToken& cancel);

// The sides that are alone on their edge. `sides` is what SortedSides makes of the triangles. O(#F).
std::vector<Side> BorderSides(std::span<const Side> sides);

}  // namespace arap
