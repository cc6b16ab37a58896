#include "core/energy/local_step.h"

#include <algorithm>
#include <cmath>

#include "core/energy/local_kernels.h"

namespace arap {
namespace {

Complex FallbackFor(Complex mean) { return mean == 0.0 ? 1.0 : mean; }

// Calls visit(begin, count, component) for blocks of at most kKernelBlock cells of one component.
template <class Visit>
void ForEachKernelBlock(const std::vector<CellRun>& runs, Visit visit) {
  for (const CellRun& run : runs) {
    for (std::size_t at = run.begin; at < run.end; at += kKernelBlock) {
      visit(at, std::min(kKernelBlock, run.end - at), run.component);
    }
  }
}

double Sum(const KernelColumn& values, std::size_t count, double sum) {
  for (std::size_t k = 0; k < count; ++k) sum += values[k];
  return sum;
}

void AddHinges(const HingeTable& table, ConstShapeView v, std::span<const Complex> mean,
               ShapeView f) {
  KernelColumn x, y;
  ForEachKernelBlock(table.runs, [&](std::size_t at, std::size_t count, std::uint32_t component) {
    const Complex middle = mean[component];
    Kernels().hinge_forces(table, at, count, v, middle, FallbackFor(middle), x, y);
    for (std::size_t k = 0; k < count; ++k) {
      const std::int32_t i = table.i[at + k], j = table.j[at + k];
      f.x[j] += x[k];
      f.y[j] += y[k];
      f.x[i] -= x[k];
      f.y[i] -= y[k];
    }
  });
}

void AddFaces(const FaceTable& table, ConstShapeView v, std::span<const Complex> mean,
              ShapeView f) {
  KernelColumn x, y;
  ForEachKernelBlock(table.runs, [&](std::size_t at, std::size_t count, std::uint32_t component) {
    const Complex middle = mean[component];
    Kernels().face_turns(table, at, count, v, middle, FallbackFor(middle), x, y);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t t = at + k;
      const Complex turn(x[k], y[k]);
      const Complex a(table.e1_x[t], table.e1_y[t]), b(table.e2_x[t], table.e2_y[t]);
      const Complex g0 = table.weight0[t] * (turn * (b - a)), g1 = table.weight1[t] * (turn * b),
                    g2 = table.weight2[t] * (turn * a);
      const std::int32_t v0 = table.v0[t], v1 = table.v1[t], v2 = table.v2[t];
      f.x[v0] -= g1.real() + g2.real();
      f.y[v0] -= g1.imag() + g2.imag();
      f.x[v1] += g2.real() - g0.real();
      f.y[v1] += g2.imag() - g0.imag();
      f.x[v2] += g0.real() + g1.real();
      f.y[v2] += g0.imag() + g1.imag();
    }
  });
}

Complex Difference(ConstShapeView v, const Spoke& s) {
  return {v.x[s.b] - v.x[s.a], v.y[s.b] - v.y[s.a]};
}

std::span<const Spoke> SpokesOf(const StarTable& table, std::size_t s) {
  return std::span(table.spokes).subspan(table.begin[s], table.begin[s + 1] - table.begin[s]);
}

Complex TurnOf(const StarTable& table, std::size_t s, ConstShapeView v, Complex fallback) {
  Complex t = 0;
  for (const Spoke& spoke : SpokesOf(table, s)) {
    t += spoke.weight * (std::conj(spoke.rest) * Difference(v, spoke));
  }
  const double size = std::sqrt(std::norm(t));
  return size > kNoDirection * table.size_of[s] ? t * (1 / size) : fallback;
}

void AddStars(const StarTable& table, ConstShapeView v, std::span<const Complex> mean,
              ShapeView f) {
  for (const CellRun& run : table.runs) {
    const Complex middle = mean[run.component];
    for (std::size_t s = run.begin; s < run.end; ++s) {
      const Complex turn = TurnOf(table, s, v, FallbackFor(middle)) - middle;
      for (const Spoke& spoke : SpokesOf(table, s)) {
        const Complex g = spoke.weight * (turn * spoke.rest);
        f.x[spoke.b] += g.real();
        f.y[spoke.b] += g.imag();
        f.x[spoke.a] -= g.real();
        f.y[spoke.a] -= g.imag();
      }
    }
  }
}

double StarEnergy(const StarTable& table, ConstShapeView v) {
  double energy = 0;
  for (std::size_t s = 0; s < table.size(); ++s) {
    const Complex turn = TurnOf(table, s, v, 1);
    for (const Spoke& spoke : SpokesOf(table, s)) {
      energy += spoke.weight * std::norm(Difference(v, spoke) - turn * spoke.rest);
    }
  }
  return energy;
}

}  // namespace

void AddRotatedEdges(const Cells& cells, ConstShapeView v, std::span<const Complex> mean,
                     ShapeView f) {
  AddHinges(cells.hinges, v, mean, f);
  AddFaces(cells.faces, v, mean, f);
  AddStars(cells.stars, v, mean, f);
}

double RigidEnergy(const Cells& cells, ConstShapeView v) {
  KernelColumn energies;
  double energy = 0;
  ForEachKernelBlock(cells.hinges.runs, [&](std::size_t at, std::size_t count, std::uint32_t) {
    Kernels().hinge_energies(cells.hinges, at, count, v, energies);
    energy = Sum(energies, count, energy);
  });
  ForEachKernelBlock(cells.faces.runs, [&](std::size_t at, std::size_t count, std::uint32_t) {
    Kernels().face_energies(cells.faces, at, count, v, energies);
    energy = Sum(energies, count, energy);
  });
  return energy + StarEnergy(cells.stars, v);
}

}  // namespace arap
