// Cutting: a surface of any kind made into charts that can be laid flat.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/flatten.h"
#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/mesh/validation.h"

namespace arap {

// Every component of `mesh` has a boundary and no handles; it may have holes unless auto_cut. No
// vertex joins parts that touch in nothing else.
//
// Triangles are the mended ones where repairs were asked for and changed something, and so is #F; the
// warnings, and the faults, speak of those that were given.
struct CutSurface {
  Repair repair;             // but for its warnings
  SurfaceMesh mesh;          // triangles in input order, turned to agree; #V' vertices
  std::vector<bool> turned;  // #F: corners 1 and 2 were swapped
  // #V': the input vertex. The first #V are the input vertices in order, those that no triangle
  // uses too; copies follow.
  std::vector<std::uint32_t> source;
  std::vector<Side> sides;                // of `mesh`: what SortedSides makes of it
  std::size_t charts = 0;                 // parts that hang together
  std::vector<std::uint32_t> chart_of;    // #F: by their lowest triangle
  std::vector<std::uint32_t> degenerate;  // triangles without area, ascending
  // Edges that were cut, the lower input vertex first: seams in the order given, then automatic
  // cuts. Not those that split_non_manifold took apart.
  std::vector<std::array<std::uint32_t, 2>> cuts;
  std::size_t auto_cuts = 0;  // how many of `cuts`, at the end, are automatic
  // Those of RepairTriangles, then "reversed_triangles", "unreferenced_vertices", "degenerate_triangles", "boundary_seams",
  // "ineffective_seams", "split_edges" (elements: triangles), "split_vertices", "one_sided" (an end of each edge).
  std::vector<Warning> warnings;
};

// Stateless, thread-safe, deterministic. `limits` bound the input. Triangles are oriented to agree
// across what is not cut, and across cuts where nothing else decides; the lowest triangle of a
// surface keeps its side.
//
// Faults, in this order: those of CheckArrays and RepairTriangles; kDuplicateTriangle; kUnknownEdge (a seam that is no
// edge: its two vertices, field "seams[i]"); kNonManifoldEdge; kNonManifoldVertex (all such
// vertices); kDegenerateTriangle; kNotOrientable; kNotADisk (the lowest triangle of every component
// that has no boundary or has handles); whatever `cancel` answers, which is asked between the
// phases and inside the searches.
//
// O(#F log #F): a second for a million triangles, two to four when it has to find cuts. At its peak
// about 120 bytes per triangle beyond the input.
Result<CutSurface> CutToCharts(SurfaceMesh mesh, const CutOptions& options,
                               const MeshLimits& limits = {}, const CancelToken& cancel = {});

}  // namespace arap
