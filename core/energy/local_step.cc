#include "core/energy/local_step.h"

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
  GatherEdges<kMost, 1, PointsBy::kBegin>(
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
  const double x1 = (ax * jx + ay * jy) + (lx * dlx + ly * dly) + (rx * drx + ry * dry);
  const double y1 = (ax * jy - ay * jx) + (lx * dly - ly * dlx) + (rx * dry - ry * drx);
  const double size = (ax * ax + ay * ay) + (lx * lx + ly * ly) + (rx * rx + ry * ry);
  Turn(x1, y1, size, mean, fallback, turn.x1, turn.y1);
  if constexpr (kBoth) {
    // Over those from j, which are differences of edges from i: what they add to the sum is
    // conj(2 along − left − right) d_j − conj(along) (d_left + d_right). The size is of the same order.
    const double mx = 2 * ax - (lx + rx), my = 2 * ay - (ly + ry);
    const double sum_x = dlx + drx, sum_y = dly + dry;
    Turn(x1 + ((mx * jx + my * jy) - (ax * sum_x + ay * sum_y)),
         y1 + ((mx * jy - my * jx) - (ax * sum_y - ay * sum_x)), size, mean, fallback, turn.x2,
         turn.y2);
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
  GatherEdges<kMost, 1, PointsBy::kNumber>(
      shape, table.v0.data() + begin, {table.v1.data() + begin, table.v2.data() + begin}, count,
      {e.ax.data(), e.bx.data()}, {e.ay.data(), e.by.data()});
}

// t̂ − mean, the rest edges and their weights; and what the three edges pull at corners 1 and 2 together, weighted
// and not yet turned: the similarity is Σ conj(pull) d of these two.
struct FaceTurn {
  double x, y, ax, ay, bx, by, w0, w1, w2, to1_x, to1_y, to2_x, to2_y;
};

ARAP_WIDE_BODY FaceTurn TurnFace(const FaceTable& table, std::size_t k, const FaceEdges& e,
                                 std::size_t own, Complex mean, Complex fallback) {
  FaceTurn turn{};
  const double ax = turn.ax = table.e1_x[k], ay = turn.ay = table.e1_y[k];
  const double bx = turn.bx = table.e2_x[k], by = turn.by = table.e2_y[k];
  const double w0 = turn.w0 = table.weight0[k];
  const double w1 = turn.w1 = table.weight1[k], w2 = turn.w2 = table.weight2[k];
  const double cx = w0 * (bx - ax), cy = w0 * (by - ay);
  const double to1_x = turn.to1_x = w2 * ax - cx, to1_y = turn.to1_y = w2 * ay - cy;
  const double to2_x = turn.to2_x = w1 * bx + cx, to2_y = turn.to2_y = w1 * by + cy;
  const double dax = e.ax[own], day = e.ay[own], dbx = e.bx[own], dby = e.by[own];
  Turn((to1_x * dax + to1_y * day) + (to2_x * dbx + to2_y * dby),
       (to1_x * day - to1_y * dax) + (to2_x * dby - to2_y * dbx),
       (to1_x * ax + to1_y * ay) + (to2_x * bx + to2_y * by), mean, fallback, turn.x, turn.y);
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
    x1[k] = t.x * t.to1_x - t.y * t.to1_y;
    y1[k] = t.x * t.to1_y + t.y * t.to1_x;
    x2[k] = t.x * t.to2_x - t.y * t.to2_y;
    y2[k] = t.x * t.to2_y + t.y * t.to2_x;
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

}  // namespace

std::span<const LocalKernels> LocalKernelsHere() {
  static constexpr LocalKernels kAll[] = {
      {HingeForcesPlain, HingeEnergyPlain, FaceForcesPlain, FaceEnergyPlain},
      {HingeForcesWide, HingeEnergyWide, FaceForcesWide, FaceEnergyWide},
      {HingeForcesWidest, HingeEnergyWidest, FaceForcesWidest, FaceEnergyWidest}};
  static const std::size_t have = HasWide() ? HasWidest() ? 3 : 2 : 1;
  return std::span(kAll).first(have);
}

}  // namespace arap
