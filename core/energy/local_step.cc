#include "core/energy/local_step.h"

#include <cmath>

namespace arap {
namespace {

Complex Difference(ConstShapeView v, std::uint32_t a, std::uint32_t b) {
  return {v.x[b] - v.x[a], v.y[b] - v.y[a]};
}

// The rotation of cell c's best similarity, or `fallback` where it has none.
Complex Rotation(const Cells& cells, std::size_t c, ConstShapeView v, Complex fallback) {
  Complex t = 0;
  for (std::uint32_t k = cells.fit_begin[c]; k < cells.fit_begin[c + 1]; ++k) {
    t += cells.fit[k].g * Difference(v, cells.fit[k].a, cells.fit[k].b);
  }
  const double size = std::sqrt(std::norm(t));
  return size > kNoDirection ? t * (1 / size) : fallback;
}

}  // namespace

void AddRotatedEdges(const Cells& cells, ConstShapeView v, std::span<const Complex> mean,
                     std::span<const std::uint32_t> component, ShapeView f) {
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const Complex middle = mean[component[cells.fit[cells.fit_begin[c]].a]];
    const Complex turn = Rotation(cells, c, v, middle == 0.0 ? 1.0 : middle) - middle;
    for (std::uint32_t k = cells.energy_begin[c]; k < cells.energy_begin[c + 1]; ++k) {
      const EnergyEdge& e = cells.energy[k];
      const Complex g = e.weight * (turn * e.rest);
      f.x[e.b] += g.real();
      f.y[e.b] += g.imag();
      f.x[e.a] -= g.real();
      f.y[e.a] -= g.imag();
    }
  }
}

double RigidEnergy(const Cells& cells, ConstShapeView v) {
  double energy = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const Complex t = Rotation(cells, c, v, 1);
    for (std::uint32_t k = cells.energy_begin[c]; k < cells.energy_begin[c + 1]; ++k) {
      const EnergyEdge& e = cells.energy[k];
      energy += e.weight * std::norm(Difference(v, e.a, e.b) - t * e.rest);
    }
  }
  return energy;
}

}  // namespace arap
