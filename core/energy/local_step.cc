#include "core/energy/local_step.h"

#include <algorithm>
#include <cmath>

#include "core/base/wide.h"

namespace arap {
namespace {

// The rotation of a similarity s = t·size, minus `mean`.
ARAP_WIDE_BODY void Turn(double sx, double sy, double size, Complex mean, Complex fallback,
                         double& x, double& y) {
  const double length = std::sqrt(sx * sx + sy * sy);
  const bool turns = length > kNoDirection * size;
  const double inverse = 1 / (turns ? length : 1);
  x = (turns ? sx * inverse : fallback.real()) - mean.real();
  y = (turns ? sy * inverse : fallback.imag()) - mean.imag();
}

// The two rotations of a hinge, minus `mean`; the second is that of j→i, 0 when there is none.
struct HingeTurn {
  double x1, y1, x2, y2, along_x, along_y, edge_x, edge_y;
};

template <bool kBoth>
ARAP_WIDE_BODY HingeTurn TurnHinge(const HingeTable& table, std::size_t k, ConstShapeView v,
                                   Complex mean, Complex fallback) {
  const std::int32_t i = table.i[k], j = table.j[k], l = table.left[k], r = table.right[k];
  const double ax = table.along_x[k], ay = table.along_y[k];
  const double lx = table.left_x[k], ly = table.left_y[k];
  const double rx = table.right_x[k], ry = table.right_y[k];
  const double px = v.x[i], py = v.y[i];
  const double jx = v.x[j] - px, jy = v.y[j] - py;
  const double dlx = v.x[l] - px, dly = v.y[l] - py;
  const double drx = v.x[r] - px, dry = v.y[r] - py;
  HingeTurn turn{0, 0, 0, 0, ax, ay, jx, jy};
  // Σ conj(rest) d over the edges from i.
  const double own_x = ax * jx + ay * jy, own_y = ax * jy - ay * jx;
  const double own_size = ax * ax + ay * ay;
  Turn(own_x + (lx * dlx + ly * dly) + (rx * drx + ry * dry),
       own_y + (lx * dly - ly * dlx) + (rx * dry - ry * drx),
       own_size + (lx * lx + ly * ly) + (rx * rx + ry * ry), mean, fallback, turn.x1, turn.y1);
  if constexpr (kBoth) {
    // Over those from j, where a boundary has no right vertex.
    const double there = r == i ? 0 : 1;
    const double mx = lx - ax, my = ly - ay, elx = dlx - jx, ely = dly - jy;
    const double nx = there * (rx - ax), ny = there * (ry - ay), erx = drx - jx, ery = dry - jy;
    Turn(own_x + (mx * elx + my * ely) + (nx * erx + ny * ery),
         own_y + (mx * ely - my * elx) + (nx * ery - ny * erx),
         own_size + (mx * mx + my * my) + (nx * nx + ny * ny), mean, fallback, turn.x2, turn.y2);
  }
  return turn;
}

template <bool kBoth>
ARAP_WIDE_BODY void HingeForcesOf(const HingeTable& table, std::size_t begin, std::size_t count,
                                  ConstShapeView v, Complex mean, Complex fallback, KernelColumn& x,
                                  KernelColumn& y) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const HingeTurn t = TurnHinge<kBoth>(table, begin + k, v, mean, fallback);
    const double w = table.weight[begin + k];
    const double c = w * (t.x1 + t.x2), s = w * (t.y1 + t.y2);
    x[k] = c * t.along_x - s * t.along_y;
    y[k] = c * t.along_y + s * t.along_x;
  }
}

ARAP_WIDE_BODY void HingeForces(const HingeTable& table, std::size_t begin, std::size_t count,
                                ConstShapeView v, Complex mean, Complex fallback, KernelColumn& x,
                                KernelColumn& y) {
  if (table.both) {
    HingeForcesOf<true>(table, begin, count, v, mean, fallback, x, y);
  } else {
    HingeForcesOf<false>(table, begin, count, v, mean, fallback, x, y);
  }
}

// |d − t e|²
ARAP_WIDE_BODY double Residual(double dx, double dy, double tx, double ty, double ex, double ey) {
  const double x = dx - (tx * ex - ty * ey), y = dy - (tx * ey + ty * ex);
  return x * x + y * y;
}

template <bool kBoth>
ARAP_WIDE_BODY void HingeEnergiesOf(const HingeTable& table, std::size_t begin, std::size_t count,
                                    ConstShapeView v, KernelColumn& energy) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const HingeTurn t = TurnHinge<kBoth>(table, begin + k, v, 0, 1);
    double sum = Residual(t.edge_x, t.edge_y, t.x1, t.y1, t.along_x, t.along_y);
    if constexpr (kBoth) {
      sum += Residual(t.edge_x, t.edge_y, t.x2, t.y2, t.along_x, t.along_y);
    }
    energy[k] = table.weight[begin + k] * sum;
  }
}

ARAP_WIDE_BODY void HingeEnergies(const HingeTable& table, std::size_t begin, std::size_t count,
                                  ConstShapeView v, KernelColumn& energy) {
  if (table.both) {
    HingeEnergiesOf<true>(table, begin, count, v, energy);
  } else {
    HingeEnergiesOf<false>(table, begin, count, v, energy);
  }
}

struct FaceTurn {
  double x, y, ax, ay, bx, by, dax, day, dbx, dby;  // t̂ − mean, rest edges, deformed edges
};

ARAP_WIDE_BODY FaceTurn TurnFace(const FaceTable& table, std::size_t k, ConstShapeView v,
                                 Complex mean, Complex fallback) {
  const std::int32_t i = table.v0[k], j = table.v1[k], l = table.v2[k];
  const double ax = table.e1_x[k], ay = table.e1_y[k], bx = table.e2_x[k], by = table.e2_y[k];
  const double w0 = table.weight0[k], w1 = table.weight1[k], w2 = table.weight2[k];
  const double cx = bx - ax, cy = by - ay;
  const double px = v.x[i], py = v.y[i];
  const double dax = v.x[j] - px, day = v.y[j] - py, dbx = v.x[l] - px, dby = v.y[l] - py;
  const double dcx = dbx - dax, dcy = dby - day;
  FaceTurn turn{0, 0, ax, ay, bx, by, dax, day, dbx, dby};
  Turn(w2 * (ax * dax + ay * day) + w1 * (bx * dbx + by * dby) + w0 * (cx * dcx + cy * dcy),
       w2 * (ax * day - ay * dax) + w1 * (bx * dby - by * dbx) + w0 * (cx * dcy - cy * dcx),
       w2 * (ax * ax + ay * ay) + w1 * (bx * bx + by * by) + w0 * (cx * cx + cy * cy), mean,
       fallback, turn.x, turn.y);
  return turn;
}

ARAP_WIDE_BODY void FaceTurns(const FaceTable& table, std::size_t begin, std::size_t count,
                              ConstShapeView v, Complex mean, Complex fallback, KernelColumn& x,
                              KernelColumn& y) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const FaceTurn t = TurnFace(table, begin + k, v, mean, fallback);
    x[k] = t.x;
    y[k] = t.y;
  }
}

ARAP_WIDE_BODY void FaceEnergies(const FaceTable& table, std::size_t begin, std::size_t count,
                                 ConstShapeView v, KernelColumn& energy) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const FaceTurn t = TurnFace(table, begin + k, v, 0, 1);
    energy[k] = table.weight2[begin + k] * Residual(t.dax, t.day, t.x, t.y, t.ax, t.ay) +
                table.weight1[begin + k] * Residual(t.dbx, t.dby, t.x, t.y, t.bx, t.by) +
                table.weight0[begin + k] *
                    Residual(t.dbx - t.dax, t.dby - t.day, t.x, t.y, t.bx - t.ax, t.by - t.ay);
  }
}

ARAP_WIDE(HingeForces, HingeForcesWide,
          (const HingeTable& table, std::size_t begin, std::size_t count, ConstShapeView v,
           Complex mean, Complex fallback, KernelColumn& x, KernelColumn& y),
          (table, begin, count, v, mean, fallback, x, y))
ARAP_WIDE(HingeEnergies, HingeEnergiesWide,
          (const HingeTable& table, std::size_t begin, std::size_t count, ConstShapeView v,
           KernelColumn& energy),
          (table, begin, count, v, energy))
ARAP_WIDE(FaceTurns, FaceTurnsWide,
          (const FaceTable& table, std::size_t begin, std::size_t count, ConstShapeView v,
           Complex mean, Complex fallback, KernelColumn& x, KernelColumn& y),
          (table, begin, count, v, mean, fallback, x, y))
ARAP_WIDE(FaceEnergies, FaceEnergiesWide,
          (const FaceTable& table, std::size_t begin, std::size_t count, ConstShapeView v,
           KernelColumn& energy),
          (table, begin, count, v, energy))

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

const LocalKernels& PlainKernels() {
  static constexpr LocalKernels kPlain{HingeForces, HingeEnergies, FaceTurns, FaceEnergies};
  return kPlain;
}

const LocalKernels& Kernels() {
  static constexpr LocalKernels kWide{HingeForcesWide, HingeEnergiesWide, FaceTurnsWide,
                                      FaceEnergiesWide};
  return HasWide() ? kWide : PlainKernels();
}

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
