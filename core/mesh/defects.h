// Defects: what could be repaired of a mesh, told when nobody asked for it; and how near is together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "arap/model/repair.h"
#include "core/mesh/topology.h"

namespace arap {

// How near is together, in units of the mesh.
struct Nearness {
  double diagonal = 0;  // of the box of all corners
  double places = 0;    // 0: only what is equal
  double sides = 0;     // of a place to a side, never 0, because lengths along a side are rounded
};
Nearness NearnessOf(std::span<const Point3> points, std::span<const Triangle> triangles,
                    const RepairOptions& options);

// What repairs would mend that were not asked for: "twin_vertices" (border vertices that lie on others;
// those of doubled triangles left out), "doubled_triangles" (corners at the same places as those of
// another one, but other vertices), "t_junctions". Each sentence names the option. A mesh that is too
// large to be measured has none. `sides` is what SortedSides makes of the triangles, `nearness` what
// NearnessOf says of them. Fault: that of `cancel`. O(n log n) for n border edges, and O(#F log #F) where there are twins.
Result<std::vector<Warning>> FindDefects(std::span<const Point3> points,
                                         std::span<const Triangle> triangles,
                                         std::span<const Side> sides, const RepairOptions& options,
                                         const Nearness& nearness, const CancelToken& cancel);

// Adds to the sentence of a fault what a repair could do about it: the first defect among the
// warnings.
Fault WithDefects(Fault fault, const std::vector<Warning>& warnings);

// The vertex that stands for each (#V) when all corners are welded; see FirstTwins.
std::vector<std::uint32_t> WeldedVertices(std::span<const Point3> points,
                                          std::span<const Triangle> triangles, double tolerance);

// A triangle that names a vertex twice.
inline bool Collapsed(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// Triangles with the same corners.
struct Duplicates {
  std::vector<std::array<std::uint32_t, 2>> pairs;  // triangle, the lowest one like it; ascending
  std::size_t opposite = 0;                         // how many of them run the other way

  std::vector<std::uint32_t> triangles() const;
  // "all run the same way: doubled" or "3 of them run the other way: both sides of a sheet".
  std::string WhichWay() const;
};
// Collapsed triangles are like no other. O(#F log #F).
Duplicates FindDuplicates(std::span<const Triangle> triangles);

}  // namespace arap
