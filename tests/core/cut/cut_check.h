// What holds of every cut surface, checked from scratch against what was cut.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/cut/cut_surface.h"

namespace arap::testing {

using Pair = std::array<std::uint32_t, 2>;

inline Pair Sorted(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

std::vector<std::string> Kinds(const std::vector<Warning>& warnings);

// The triangles of every edge.
std::map<Pair, std::vector<std::uint32_t>> Edges(const std::vector<Triangle>& triangles);

// Of its mesh, from scratch.
Topology TopologyOf(const CutSurface& cut);

// Of every component, counted from the triangles.
std::vector<int> EulerCharacteristics(const CutSurface& cut);

// Welded by `source` it is the input, corner by corner, with triangles turned where it says so; it
// is oriented, manifold and planar; and what came apart is what `cuts` lists.
void CheckAgainst(const SurfaceMesh& input, const CutSurface& cut);

// CutToCharts with CheckAgainst; a fault ends the test.
CutSurface MustCut(const SurfaceMesh& input, const CutOptions& options);

// MustCut, and so many disks come out.
CutSurface MustCutToDisks(const SurfaceMesh& input, std::size_t disks, const CutOptions& options);

// The fault that has to come.
Fault FaultOf(const SurfaceMesh& input, const CutOptions& options);

// A mesh of the plane as a surface.
SurfaceMesh Flat(const PlanarMesh& mesh);

// Three sheets on one edge 0-1.
SurfaceMesh ThreeSheets();

double LengthOf(const SurfaceMesh& mesh, const std::vector<Pair>& edges);

CutOptions WithSeams(std::vector<Pair> seams);

inline CutOptions AutoCut() {
  CutOptions options;
  options.auto_cut = true;
  return options;
}

}  // namespace arap::testing
