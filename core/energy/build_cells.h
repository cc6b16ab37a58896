// From a mesh and its options to the cells of its energy [algorithm §3, II09 §4.2, §7].
#pragma once

#include <cstddef>
#include <functional>

#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "core/energy/cells.h"
#include "core/mesh/topology.h"
#include "core/mesh/validation.h"

namespace arap {

// A triangle laid flat: its corners in its own frame, counter-clockwise.
using TriangleFrame = std::function<std::array<Complex, 3>(std::uint32_t triangle)>;

struct CellSystem {
  Cells cells;
  std::size_t clamped = 0;  // edges whose cotangent was raised to kMinCotangent
};

// The warning "clamped_weights" of so many edges.
Warning ClampedWarning(std::size_t edges);

// Rigidity must be empty or one number in (0, kMaxRigidity] per triangle: kArrayLength,
// kInvalidOption.
Status CheckEnergyOptions(const EnergyOptions& options, std::size_t triangles);

// Builds the cells. `frame` gives each triangle's shape; for EDGE cells the two triangles of a
// hinge are unfolded about their edge, one on each side, as their orientation says. VERTEX cells
// need one common frame (planar meshes); asking for them on a surface is kInvalidOption.
//
// Triangles in `left_out` (#F or empty) count next to nothing: their cotangents are replaced by
// kMinCotangent, so that a vertex that has no other triangle still has a place.
//
// Pieces that meet only in a joint vertex are welded there by one extra cell, the spokes of the
// joint: without it nothing would fix how they turn against each other.
Result<CellSystem> BuildCells(const std::vector<Triangle>& triangles, const Topology& topology,
                              const EnergyOptions& options, const TriangleFrame& frame, bool planar,
                              const std::vector<bool>& left_out = {});

}  // namespace arap
