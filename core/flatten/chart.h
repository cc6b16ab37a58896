// Chart: one connected piece of a cut surface on its way to the plane.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/mesh.h"
#include "core/cut/cut_surface.h"
#include "core/energy/cells.h"
#include "core/mesh/topology.h"

namespace arap {

// Vertices and triangles are numbered anew, without unreferenced ones; coordinates are relative to
// the middle of the bounding box and in units of its diagonal.
struct Chart {
  SurfaceMesh mesh;
  Topology topology;                     // without edges where MakeCharts was not asked for them
  std::vector<std::uint32_t> vertices;   // #V, in the cut surface
  std::vector<std::uint32_t> triangles;  // #F, in the cut surface
  std::vector<std::vector<std::uint32_t>> loops;  // ordered boundaries, the longest first
  std::array<std::uint32_t, 2> centre{};          // CentreEdge
  std::vector<bool> left_out;                     // #F or empty: triangles without area
  double diagonal = 1;

  // The triangle laid flat; as a sliver of the right lengths where it has no area. Not stored: to make it
  // takes no longer than to fetch it.
  std::array<Complex, 3> Frame(std::uint32_t t) const;

  // Cells on these frames, or on `flat` of somebody else (#F). EDGE cells need the edges.
  Result<CellSystem> Cells(const EnergyOptions& options) const;
  Result<CellSystem> Cells(const EnergyOptions& options,
                           const std::vector<std::array<Complex, 3>>& flat) const;
};

// The charts of a surface, by their lowest triangle, whose mesh and sides are taken from it. `edges`: with
// the topology of every chart, for EDGE cells and angles. O(#F log #F). Faults: what `cancel` answers
// between charts.
Result<std::vector<Chart>> MakeCharts(CutSurface& surface, bool edges = true,
                                      const CancelToken& cancel = {});

// Ends of the edge whose middle is nearest to the area centroid; of the lowest such edge. Edges
// without length do not count [II09 §7 "an edge at the center of the mesh"]. `sides` is what SortedSides
// makes of the triangles.
std::array<std::uint32_t, 2> CentreEdge(const SurfaceMesh& mesh, std::span<const Side> sides);

}  // namespace arap
