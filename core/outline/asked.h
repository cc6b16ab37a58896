// What may be asked of the mesher, from where it counts, and what that costs.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/outline.h"

namespace arap {

// What may be asked for, and what a mesh may have when narrow places need more; besides, it has at
// most a hundred for each vertex that was asked for and each point of the outlines.
inline constexpr std::size_t kMaxAskedVertices = 1'000'000;
inline constexpr std::size_t kMaxMeshVertices = 1'500'000;

// Of all outlines together.
std::size_t PointsOf(std::span<const Outline> outlines);

// The faults of MeshOutlines that show before the work: those of outlines, and of the vertices too.
Status CheckOutlines(std::span<const Outline> outlines);
Status CheckAsked(std::span<const Outline> outlines, std::size_t vertices);

// 0, or where outlines (finite) are far from it for their size, a corner of their box: counted from
// there they keep all their digits. The differences are exact, since no coordinate is then twice
// another one.
Complex OriginOf(std::span<const Outline> outlines);
std::vector<Outline> CountedFrom(Complex origin, std::span<const Outline> outlines);

// What a mesh takes at most in outlines of so many points in all, but where they are narrow.
struct MeshingCost {
  double seconds = 0;     // of processor time
  std::size_t bytes = 0;  // at the peak
};
MeshingCost EstimateMeshing(std::size_t points, std::size_t vertices, std::size_t most);

}  // namespace arap
