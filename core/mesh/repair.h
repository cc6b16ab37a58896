// Repair: a mesh mended as RepairOptions say, and which vertices and triangles of the mended one are
// which of those that were given.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "arap/model/repair.h"
#include "core/mesh/topology.h"

namespace arap {

// #V and #F are those of the mesh that was given, #F' the triangles of the mended one, whose parts are
// the mended triangles that make up a given one.
struct Repair {
  std::vector<Triangle>
      given;  // #F; empty: nothing was changed, and all below but `warnings` is too
  // #V: the vertex that stands for each. Those that do not stand for themselves are in no mended triangle.
  std::vector<std::uint32_t> vertex;
  std::vector<std::uint32_t> triangle;  // #F', ascending: the given triangle
  // Given triangles that have no parts of their own, ascending, and the one that was kept in their
  // place; kNone for one that collapsed.
  std::vector<std::array<std::uint32_t, 2>> dropped;
  // Edges that were split (the lower vertex first, both standing for themselves): the vertices inside,
  // from the lower to the higher.
  std::map<std::array<std::uint32_t, 2>, std::vector<std::uint32_t>> split;
  // "welded_vertices", "collapsed_triangles", "dropped_triangles", "split_triangles"; then those of
  // FindDefects (defects.h) for what was not asked for.
  std::vector<Warning> warnings;

  bool changed() const { return !given.empty(); }
  // Itself where nothing was changed, and for what is out of range.
  std::uint32_t VertexOf(std::uint32_t v) const { return v < vertex.size() ? vertex[v] : v; }
  std::uint32_t TriangleOf(std::uint32_t t) const { return t < triangle.size() ? triangle[t] : t; }
  Triangle CornersOf(
      std::uint32_t given_triangle) const;  // standing for themselves; when changed()
  // The parts of a given triangle, or of the one that was kept in its place: [begin, end) of the mended
  // triangles. When changed().
  struct Parts {
    std::uint32_t begin = 0, end = 0;
    std::uint32_t size() const { return end - begin; }
  };
  Parts PartsOf(std::uint32_t given_triangle) const;

  // A fault or a warning about mended triangles, told of the given ones; of a fault the sentence too.
  Fault OfGiven(Fault fault) const;
  Warning OfGiven(Warning warning) const;
  // Edges on the vertices that stand for theirs. Of one that was split the first part is in its place and
  // the others are at the end.
  std::vector<std::array<std::uint32_t, 2>> OfMended(
      std::vector<std::array<std::uint32_t, 2>> edges) const;
  // Options with the rigidity of the mended triangles; it must be empty or #F.
  EnergyOptions OfMended(EnergyOptions options) const;
};

// What can be said of the options without a mesh. kInvalidOption with the field "repair.tolerance".
Status CheckRepair(const RepairOptions& options);

// Mends the triangles in place. Indices must name vertices, three different ones for a triangle, and
// coordinates must be finite. Welding alone and leaving out duplicates add no triangle; stitching adds
// at most four for each border edge. What is left to be mended is told as FindDefects does.
//
// Faults: kInvalidOption (fields "repair.tolerance": more than kMaxRepairTolerance of the diagonal;
// "repair.stitch": borders that lie on one another again and again), kEmptyMesh when every triangle
// collapses, kMeshTooLarge beyond `limits`, and that of `cancel`.
//
// O(n log n) for n vertices and triangles; about 100 bytes for each at the peak, and 20 that stay where
// something was changed. `sides`, where it is wanted, becomes what SortedSides makes of the mended
// triangles.
Result<Repair> RepairTriangles(std::span<const Point3> points, std::vector<Triangle>& triangles,
                               const RepairOptions& options, const MeshLimits& limits,
                               const CancelToken& cancel, std::vector<Side>* sides = nullptr);

// Points of the plane in space.
std::vector<Point3> InSpace(std::span<const Complex> points);

}  // namespace arap
