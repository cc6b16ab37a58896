// A face of several corners cut into triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/mesh.h"

namespace arap {

// How a polygon was cut.
enum class PolygonCut : std::uint8_t {
  kFan,      // from its first corner; a convex one always is
  kEars,     // a concave one, along diagonals inside
  kUnclear,  // a fan all the same: it has no area or crosses itself, so there is no right cut
  kTooLong,  // not at all: concave with more than kMaxConcaveCorners
};

inline constexpr std::size_t kMaxConcaveCorners = 4096;

// Appends the #corners − 2 triangles of a polygon of three or more corners, in its direction. What
// is inside is judged in the plane that fits it best. No triangle is without area where that can
// be: corners on a straight side are no reason for one. A triangle is appended as it is. O(n) for a
// fan, O(n²) with ears. Any finite vertices; the same polygon is cut in the same way.
PolygonCut CutPolygon(std::span<const Point3> vertices, std::span<const std::uint32_t> corners,
                      std::vector<Triangle>& triangles);

}  // namespace arap
