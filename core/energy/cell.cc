#include "core/energy/cell.h"

namespace arap {

std::size_t Cells::bytes() const {
  return (fit_begin.capacity() + energy_begin.capacity()) * sizeof(std::uint32_t) +
         fit.capacity() * sizeof(FitEdge) + energy.capacity() * sizeof(EnergyEdge);
}

void Cells::Add(std::span<const CellEdge> fit_edges, std::span<const CellEdge> energy_edges) {
  double sum = 0;
  for (const CellEdge& e : fit_edges) sum += e.weight * std::norm(e.rest);
  for (const CellEdge& e : fit_edges) {
    fit.push_back({e.a, e.b, e.weight * std::conj(e.rest) / sum});
  }
  for (const CellEdge& e : energy_edges) {
    if (e.weight != 0) energy.push_back({e.a, e.b, e.rest, e.weight});
  }
  fit_begin.push_back(static_cast<std::uint32_t>(fit.size()));
  energy_begin.push_back(static_cast<std::uint32_t>(energy.size()));
}

}  // namespace arap
