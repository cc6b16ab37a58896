#include "core/energy/local_step.h"

#include <algorithm>
#include <cmath>

#include "core/base/lanes.h"
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

// From i to j, left and right of a block of hinges, in a shape.
struct HingeEdges {
  KernelColumn jx, jy, lx, ly, rx, ry;
};

template <std::size_t kMost>
ARAP_WIDE_BODY void GatherHinges(const HingeTable& table, std::size_t begin, std::size_t count,
                                 const double* shape, HingeEdges& e) {
  GatherEdges<kMost, 1, 3>(
      shape, table.i.data() + begin,
      {table.j.data() + begin, table.left.data() + begin, table.right.data() + begin}, count,
      {e.jx.data(), e.lx.data(), e.rx.data()}, {e.jy.data(), e.ly.data(), e.ry.data()});
}

// The two rotations of a hinge, minus `mean`; the second is that of j→i, 0 when there is none.
struct HingeTurn {
  double x1, y1, x2, y2;
};

// Hinge k of a table, which is at `own` of its block.
template <bool kBoth>
ARAP_WIDE_BODY HingeTurn TurnHinge(const HingeTable& table, std::size_t k, const HingeEdges& e,
                                   std::size_t own, Complex mean, Complex fallback) {
  const double ax = table.along_x[k], ay = table.along_y[k];
  const double lx = table.left_x[k], ly = table.left_y[k];
  const double rx = table.right_x[k], ry = table.right_y[k];
  const double jx = e.jx[own], jy = e.jy[own];
  const double dlx = e.lx[own], dly = e.ly[own], drx = e.rx[own], dry = e.ry[own];
  HingeTurn turn{0, 0, 0, 0};
  // Σ conj(rest) d over the edges from i.
  const double own_x = ax * jx + ay * jy, own_y = ax * jy - ay * jx;
  const double own_size = ax * ax + ay * ay;
  Turn(own_x + (lx * dlx + ly * dly) + (rx * drx + ry * dry),
       own_y + (lx * dly - ly * dlx) + (rx * dry - ry * drx),
       own_size + (lx * lx + ly * ly) + (rx * rx + ry * ry), mean, fallback, turn.x1, turn.y1);
  if constexpr (kBoth) {
    // Over those from j, where a boundary has no right vertex.
    const double there = table.right[k] == table.i[k] ? 0 : 1;
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
                                  const HingeEdges& edges, Complex mean, Complex fallback,
                                  KernelColumn& x, KernelColumn& y) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const HingeTurn t = TurnHinge<kBoth>(table, begin + k, edges, k, mean, fallback);
    const double w = table.weight[begin + k];
    const double ax = table.along_x[begin + k], ay = table.along_y[begin + k];
    const double c = w * (t.x1 + t.x2), s = w * (t.y1 + t.y2);
    x[k] = c * ax - s * ay;
    y[k] = c * ay + s * ax;
  }
}

template <std::size_t kMost>
ARAP_WIDE_BODY void HingeForces(const HingeTable& table, std::size_t begin, std::size_t count,
                                const double* shape, Complex mean, Complex fallback,
                                KernelColumn& x, KernelColumn& y) {
  HingeEdges edges;
  GatherHinges<kMost>(table, begin, count, shape, edges);
  if (table.both) {
    HingeForcesOf<true>(table, begin, count, edges, mean, fallback, x, y);
  } else {
    HingeForcesOf<false>(table, begin, count, edges, mean, fallback, x, y);
  }
}

// |d − t e|²
ARAP_WIDE_BODY double Residual(double dx, double dy, double tx, double ty, double ex, double ey) {
  const double x = dx - (tx * ex - ty * ey), y = dy - (tx * ey + ty * ex);
  return x * x + y * y;
}

template <bool kBoth>
ARAP_WIDE_BODY void HingeEnergiesOf(const HingeTable& table, std::size_t begin, std::size_t count,
                                    const HingeEdges& edges, KernelColumn& energy) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const HingeTurn t = TurnHinge<kBoth>(table, begin + k, edges, k, 0, 1);
    const double ax = table.along_x[begin + k], ay = table.along_y[begin + k];
    double sum = Residual(edges.jx[k], edges.jy[k], t.x1, t.y1, ax, ay);
    if constexpr (kBoth) sum += Residual(edges.jx[k], edges.jy[k], t.x2, t.y2, ax, ay);
    energy[k] = table.weight[begin + k] * sum;
  }
}

template <std::size_t kMost>
ARAP_WIDE_BODY void HingeEnergy(const HingeTable& table, std::size_t begin, std::size_t count,
                                const double* shape, double& energy) {
  HingeEdges edges;
  KernelColumn energies;
  GatherHinges<kMost>(table, begin, count, shape, edges);
  if (table.both) {
    HingeEnergiesOf<true>(table, begin, count, edges, energies);
  } else {
    HingeEnergiesOf<false>(table, begin, count, edges, energies);
  }
  energy = SumOf(energies.data(), count);
}

// From corner 0 to corners 1 and 2 of a block of faces, in a shape.
struct FaceEdges {
  KernelColumn ax, ay, bx, by;
};

template <std::size_t kMost>
ARAP_WIDE_BODY void GatherFaces(const FaceTable& table, std::size_t begin, std::size_t count,
                                const double* shape, FaceEdges& e) {
  GatherEdges<kMost, 1, 2>(shape, table.v0.data() + begin,
                           {table.v1.data() + begin, table.v2.data() + begin}, count,
                           {e.ax.data(), e.bx.data()}, {e.ay.data(), e.by.data()});
}

struct FaceTurn {
  double x, y, ax, ay, bx, by, w0, w1, w2;  // t̂ − mean, rest edges, weights
};

ARAP_WIDE_BODY FaceTurn TurnFace(const FaceTable& table, std::size_t k, const FaceEdges& e,
                                 std::size_t own, Complex mean, Complex fallback) {
  FaceTurn turn{0,
                0,
                table.e1_x[k],
                table.e1_y[k],
                table.e2_x[k],
                table.e2_y[k],
                table.weight0[k],
                table.weight1[k],
                table.weight2[k]};
  const double ax = turn.ax, ay = turn.ay, bx = turn.bx, by = turn.by;
  const double w0 = turn.w0, w1 = turn.w1, w2 = turn.w2;
  const double cx = bx - ax, cy = by - ay;
  const double dax = e.ax[own], day = e.ay[own], dbx = e.bx[own], dby = e.by[own];
  const double dcx = dbx - dax, dcy = dby - day;
  Turn(w2 * (ax * dax + ay * day) + w1 * (bx * dbx + by * dby) + w0 * (cx * dcx + cy * dcy),
       w2 * (ax * day - ay * dax) + w1 * (bx * dby - by * dbx) + w0 * (cx * dcy - cy * dcx),
       w2 * (ax * ax + ay * ay) + w1 * (bx * bx + by * by) + w0 * (cx * cx + cy * cy), mean,
       fallback, turn.x, turn.y);
  return turn;
}

template <std::size_t kMost>
ARAP_WIDE_BODY void FaceForces(const FaceTable& table, std::size_t begin, std::size_t count,
                               const double* shape, Complex mean, Complex fallback,
                               KernelColumn& x1, KernelColumn& y1, KernelColumn& x2,
                               KernelColumn& y2) {
  FaceEdges edges;
  GatherFaces<kMost>(table, begin, count, shape, edges);
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const FaceTurn t = TurnFace(table, begin + k, edges, k, mean, fallback);
    // Along the edges from corner 0 to 1, from 0 to 2, from 1 to 2, before they are turned.
    const double ax = t.w2 * t.ax, ay = t.w2 * t.ay, bx = t.w1 * t.bx, by = t.w1 * t.by;
    const double cx = t.w0 * (t.bx - t.ax), cy = t.w0 * (t.by - t.ay);
    const double to1_x = ax - cx, to1_y = ay - cy, to2_x = bx + cx, to2_y = by + cy;
    x1[k] = t.x * to1_x - t.y * to1_y;
    y1[k] = t.x * to1_y + t.y * to1_x;
    x2[k] = t.x * to2_x - t.y * to2_y;
    y2[k] = t.x * to2_y + t.y * to2_x;
  }
}

template <std::size_t kMost>
ARAP_WIDE_BODY void FaceEnergy(const FaceTable& table, std::size_t begin, std::size_t count,
                               const double* shape, double& energy) {
  FaceEdges edges;
  KernelColumn energies;
  GatherFaces<kMost>(table, begin, count, shape, edges);
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const FaceTurn t = TurnFace(table, begin + k, edges, k, 0, 1);
    const double dax = edges.ax[k], day = edges.ay[k], dbx = edges.bx[k], dby = edges.by[k];
    energies[k] = t.w2 * Residual(dax, day, t.x, t.y, t.ax, t.ay) +
                  t.w1 * Residual(dbx, dby, t.x, t.y, t.bx, t.by) +
                  t.w0 * Residual(dbx - dax, dby - day, t.x, t.y, t.bx - t.ax, t.by - t.ay);
  }
  energy = SumOf(energies.data(), count);
}

#define ARAP_LOCAL_TWINS(name, parameters, arguments)   \
  void name##Plain parameters { name<2> arguments; }    \
  ARAP_WIDE(name<4>, name##Wide, parameters, arguments) \
  ARAP_WIDEST(name<8>, name##Widest, parameters, arguments)
ARAP_LOCAL_TWINS(HingeForces,
                 (const HingeTable& table, std::size_t begin, std::size_t count,
                  const double* shape, Complex mean, Complex fallback, KernelColumn& x,
                  KernelColumn& y),
                 (table, begin, count, shape, mean, fallback, x, y))
ARAP_LOCAL_TWINS(HingeEnergy,
                 (const HingeTable& table, std::size_t begin, std::size_t count,
                  const double* shape, double& energy),
                 (table, begin, count, shape, energy))
ARAP_LOCAL_TWINS(FaceForces,
                 (const FaceTable& table, std::size_t begin, std::size_t count, const double* shape,
                  Complex mean, Complex fallback, KernelColumn& x1, KernelColumn& y1,
                  KernelColumn& x2, KernelColumn& y2),
                 (table, begin, count, shape, mean, fallback, x1, y1, x2, y2))
ARAP_LOCAL_TWINS(FaceEnergy,
                 (const FaceTable& table, std::size_t begin, std::size_t count, const double* shape,
                  double& energy),
                 (table, begin, count, shape, energy))
#undef ARAP_LOCAL_TWINS

Complex FallbackFor(Complex mean) { return mean == 0.0 ? 1.0 : mean; }

// A complex number is two doubles in a row, says the standard.
const double* NumbersAt(std::span<const Complex> points) {
  return reinterpret_cast<const double*>(points.data());
}
double* NumbersAt(std::span<Complex> points) { return reinterpret_cast<double*>(points.data()); }

// Calls visit(begin, count, component) for blocks of at most kKernelBlock cells of one component.
template <class Visit>
void ForEachKernelBlock(const std::vector<CellRun>& runs, Visit visit) {
  for (const CellRun& run : runs) {
    for (std::size_t at = run.begin; at < run.end; at += kKernelBlock) {
      visit(at, std::min(kKernelBlock, run.end - at), run.component);
    }
  }
}

void AddHinges(const LocalKernels& kernels, const HingeTable& table, const double* shape,
               std::span<const Complex> mean, double* force) {
  KernelColumn x, y;
  ForEachKernelBlock(table.runs, [&](std::size_t at, std::size_t count, std::uint32_t component) {
    const Complex middle = mean[component];
    kernels.hinge_forces(table, at, count, shape, middle, FallbackFor(middle), x, y);
    for (std::size_t k = 0; k < count; ++k) {
      const Pair own{x[k], y[k]};
      PairAt(force, static_cast<std::size_t>(table.j[at + k])) += own;
      PairAt(force, static_cast<std::size_t>(table.i[at + k])) -= own;
    }
  });
}

void AddFaces(const LocalKernels& kernels, const FaceTable& table, const double* shape,
              std::span<const Complex> mean, double* force) {
  KernelColumn x1, y1, x2, y2;
  ForEachKernelBlock(table.runs, [&](std::size_t at, std::size_t count, std::uint32_t component) {
    const Complex middle = mean[component];
    kernels.face_forces(table, at, count, shape, middle, FallbackFor(middle), x1, y1, x2, y2);
    for (std::size_t k = 0; k < count; ++k) {
      const Pair first{x1[k], y1[k]}, second{x2[k], y2[k]};
      PairAt(force, static_cast<std::size_t>(table.v0[at + k])) -= first + second;
      PairAt(force, static_cast<std::size_t>(table.v1[at + k])) += first;
      PairAt(force, static_cast<std::size_t>(table.v2[at + k])) += second;
    }
  });
}

Complex Difference(std::span<const Complex> v, const Spoke& s) { return v[s.b] - v[s.a]; }

std::span<const Spoke> SpokesOf(const StarTable& table, std::size_t s) {
  return std::span(table.spokes).subspan(table.begin[s], table.begin[s + 1] - table.begin[s]);
}

Complex TurnOf(const StarTable& table, std::size_t s, std::span<const Complex> v,
               Complex fallback) {
  Complex t = 0;
  for (const Spoke& spoke : SpokesOf(table, s)) {
    t += spoke.weight * (std::conj(spoke.rest) * Difference(v, spoke));
  }
  const double size = std::sqrt(std::norm(t));
  return size > kNoDirection * table.size_of[s] ? t * (1 / size) : fallback;
}

void AddStars(const StarTable& table, std::span<const Complex> v, std::span<const Complex> mean,
              std::span<Complex> f) {
  for (const CellRun& run : table.runs) {
    const Complex middle = mean[run.component];
    for (std::size_t s = run.begin; s < run.end; ++s) {
      const Complex turn = TurnOf(table, s, v, FallbackFor(middle)) - middle;
      for (const Spoke& spoke : SpokesOf(table, s)) {
        const Complex g = spoke.weight * (turn * spoke.rest);
        f[spoke.b] += g;
        f[spoke.a] -= g;
      }
    }
  }
}

double StarEnergy(const StarTable& table, std::span<const Complex> v) {
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

std::span<const LocalKernels> LocalKernelsHere() {
  static constexpr LocalKernels kAll[] = {
      {HingeForcesPlain, HingeEnergyPlain, FaceForcesPlain, FaceEnergyPlain},
      {HingeForcesWide, HingeEnergyWide, FaceForcesWide, FaceEnergyWide},
      {HingeForcesWidest, HingeEnergyWidest, FaceForcesWidest, FaceEnergyWidest}};
  static const std::size_t have = HasWide() ? HasWidest() ? 3 : 2 : 1;
  return std::span(kAll).first(have);
}

void AddRotatedEdges(const Cells& cells, std::span<const Complex> shape,
                     std::span<const Complex> mean, std::span<Complex> force) {
  const LocalKernels& kernels = LocalKernelsHere().back();
  AddHinges(kernels, cells.hinges, NumbersAt(shape), mean, NumbersAt(force));
  AddFaces(kernels, cells.faces, NumbersAt(shape), mean, NumbersAt(force));
  AddStars(cells.stars, shape, mean, force);
}

double RigidEnergy(const Cells& cells, std::span<const Complex> shape) {
  const LocalKernels& kernels = LocalKernelsHere().back();
  double energy = 0, block = 0;
  ForEachKernelBlock(cells.hinges.runs, [&](std::size_t at, std::size_t count, std::uint32_t) {
    kernels.hinge_energy(cells.hinges, at, count, NumbersAt(shape), block);
    energy += block;
  });
  ForEachKernelBlock(cells.faces.runs, [&](std::size_t at, std::size_t count, std::uint32_t) {
    kernels.face_energy(cells.faces, at, count, NumbersAt(shape), block);
    energy += block;
  });
  return energy + StarEnergy(cells.stars, shape);
}

}  // namespace arap
