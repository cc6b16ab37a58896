// Chart: one connected piece of a cut surface on its way to the plane.
#pragma once

#include <array>
#include <cstdint>
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
  Topology topology;
  std::vector<std::uint32_t> vertices;            // #V, in the cut surface
  std::vector<std::uint32_t> triangles;           // #F, in the cut surface
  std::vector<std::vector<std::uint32_t>> loops;  // ordered boundaries, the longest first
  std::vector<std::array<Complex, 3>> frames;     // #F, every triangle laid flat
  std::vector<bool> left_out;                     // #F or empty: triangles without area
  double diagonal = 1;

  // Cells on these frames, or on `frames` of somebody else (#F).
  Result<CellSystem> Cells(const EnergyOptions& options) const { return Cells(options, frames); }
  Result<CellSystem> Cells(const EnergyOptions& options,
                           const std::vector<std::array<Complex, 3>>& flat) const;
};

// The charts of a surface, by their lowest triangle. O(#F log #F). Faults: what `cancel` answers
// between charts.
Result<std::vector<Chart>> MakeCharts(const CutSurface& surface, const CancelToken& cancel = {});

}  // namespace arap
