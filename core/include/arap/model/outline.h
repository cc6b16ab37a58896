// Outlines, and the triangles inside them. Plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// A closed curve; the first point is not repeated.
using Outline = std::vector<Complex>;

// What outlines may have in points, together.
inline constexpr std::size_t kMaxOutlinePoints = 1'000'000;

// What becomes of outlines before they are filled with triangles, and how fine these are. Lengths are
// in the unit of the outlines.
struct OutlineOptions {
  std::uint32_t vertices = 0;  // about; 0: 1000
  double tolerance = 0;        // by how much outlines may be simplified; 0: every point is kept
  double expansion = 0;        // grow by so much, round corners by arcs

  bool operator==(const OutlineOptions&) const = default;
};

struct QualityMesh {
  // Counter-clockwise, no loose vertices, in an order that depends on the outlines alone;
  // coordinates have nine digits of the largest, or of the size of outlines that are far from 0.
  PlanarMesh mesh;
  std::size_t pieces = 0;     // connected through edges
  std::size_t holes = 0;      // of all pieces
  double smallest_angle = 0;  // degrees
  // How far its border is at most from that of what was asked for: 0 when nothing was simplified or
  // grown.
  double outline_error = 0;

  bool operator==(const QualityMesh&) const = default;
};

}  // namespace arap
