// Outlines, and the triangles inside them. Plain values.
#pragma once

#include <cstddef>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// A closed curve; the first point is not repeated.
using Outline = std::vector<Complex>;

// What outlines may have in points, together.
inline constexpr std::size_t kMaxOutlinePoints = 1'000'000;

struct QualityMesh {
  // Counter-clockwise, no loose vertices, in an order that depends on the outlines alone;
  // coordinates have nine digits of the largest, or of the size of outlines that are far from 0.
  PlanarMesh mesh;
  std::size_t pieces = 0;     // connected through edges
  std::size_t holes = 0;      // of all pieces
  double smallest_angle = 0;  // degrees

  bool operator==(const QualityMesh&) const = default;
};

}  // namespace arap
