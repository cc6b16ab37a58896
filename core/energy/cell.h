// Cells: the pieces of a mesh that have one best similarity each [algorithm §3].
//
// A cell has fit edges (a, b, ω), which decide its similarity t, and energy edges (a, b, w), which
// are compared with it. Rest vectors are in the cell's own frame, so that cells of a planar mesh
// and hinges of a surface laid flat one by one are the same thing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/mesh.h"

namespace arap {

struct CellEdge {
  std::uint32_t a = 0, b = 0;
  Complex rest;       // p_b − p_a in the cell's frame
  double weight = 0;  // ω of a fit edge, w of an energy edge
};

struct FitEdge {
  std::uint32_t a = 0, b = 0;
  Complex g;  // t = Σ g (v_b − v_a);  g = ω conj(p_b − p_a) / Σ ω |p_b − p_a|²
};

struct EnergyEdge {
  std::uint32_t a = 0, b = 0;
  Complex rest;
  double weight = 0;
};

// Compressed rows: cell c has fit[fit_begin[c] … fit_begin[c+1]) and likewise energy edges.
struct Cells {
  std::vector<std::uint32_t> fit_begin{0};
  std::vector<std::uint32_t> energy_begin{0};
  std::vector<FitEdge> fit;
  std::vector<EnergyEdge> energy;

  std::size_t size() const { return fit_begin.size() - 1; }
  std::size_t bytes() const;
  // Appends one cell. Energy edges of weight 0 are left out.
  void Add(std::span<const CellEdge> fit_edges, std::span<const CellEdge> energy_edges);
};

}  // namespace arap
