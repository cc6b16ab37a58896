#include "core/energy/rigid_descent.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace arap {
namespace {

// Where the kernels write: rotations, and 1/|S|.
struct Turns {
  double *x, *y, *inverse;
};
struct ConstTurns {
  const double *x, *y, *inverse;
};

ARAP_WIDE_BODY void FacePulls(const FaceTable& table, std::size_t begin, std::size_t count,
                              ConstShapeView v, Turns turns, CornerPulls& out) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t f = begin + k;
    const std::int32_t i = table.v0[f], j = table.v1[f], l = table.v2[f];
    const double ax = table.e1_x[f], ay = table.e1_y[f], bx = table.e2_x[f], by = table.e2_y[f];
    const double w0 = table.weight0[f], w1 = table.weight1[f], w2 = table.weight2[f];
    const double cx = bx - ax, cy = by - ay;
    const double px = v.x[i], py = v.y[i];
    const double dax = v.x[j] - px, day = v.y[j] - py, dbx = v.x[l] - px, dby = v.y[l] - py;
    const double dcx = dbx - dax, dcy = dby - day;
    const double sx =
        w2 * (ax * dax + ay * day) + w1 * (bx * dbx + by * dby) + w0 * (cx * dcx + cy * dcy);
    const double sy =
        w2 * (ax * day - ay * dax) + w1 * (bx * dby - by * dbx) + w0 * (cx * dcy - cy * dcx);
    const double size =
        w2 * (ax * ax + ay * ay) + w1 * (bx * bx + by * by) + w0 * (cx * cx + cy * cy);
    const double length = std::sqrt(sx * sx + sy * sy);
    const bool turned = length > kNoDirection * size;
    const double inverse = 1 / (turned ? length : 1);
    const double x = turned ? sx * inverse : 1, y = turned ? sy * inverse : 0;
    turns.x[f] = x;
    turns.y[f] = y;
    turns.inverse[f] = turned ? inverse : 0;
    // (v_b − v_a) − t̂ e of the three edges.
    const double rax = dax - (x * ax - y * ay), ray = day - (x * ay + y * ax);
    const double rbx = dbx - (x * bx - y * by), rby = dby - (x * by + y * bx);
    const double rcx = rbx - rax, rcy = rby - ray;
    out.x1[k] = w0 * rcx - w2 * rax;
    out.y1[k] = w0 * rcy - w2 * ray;
    out.x2[k] = -(w1 * rbx + w0 * rcx);
    out.y2[k] = -(w1 * rby + w0 * rcy);
    out.energy[k] =
        w2 * (rax * rax + ray * ray) + w1 * (rbx * rbx + rby * rby) + w0 * (rcx * rcx + rcy * rcy);
  }
}

ARAP_WIDE_BODY void FaceBends(const FaceTable& table, std::size_t begin, std::size_t count,
                              ConstShapeView d, ConstTurns turns, KernelColumn& bend) {
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t f = begin + k;
    const std::int32_t i = table.v0[f], j = table.v1[f], l = table.v2[f];
    const double x = turns.x[f], y = turns.y[f];
    const double ax = table.e1_x[f], ay = table.e1_y[f], bx = table.e2_x[f], by = table.e2_y[f];
    const double tax = x * ax - y * ay, tay = x * ay + y * ax;
    const double tbx = x * bx - y * by, tby = x * by + y * bx;
    const double tcx = tbx - tax, tcy = tby - tay;
    const double px = d.x[i], py = d.y[i];
    const double dax = d.x[j] - px, day = d.y[j] - py, dbx = d.x[l] - px, dby = d.y[l] - py;
    const double dcx = dbx - dax, dcy = dby - day;
    const double turn = table.weight2[f] * (tax * day - tay * dax) +
                        table.weight1[f] * (tbx * dby - tby * dbx) +
                        table.weight0[f] * (tcx * dcy - tcy * dcx);
    bend[k] = turn * turn * turns.inverse[f];
  }
}

ARAP_WIDE(FacePulls, FacePullsWide,
          (const FaceTable& table, std::size_t begin, std::size_t count, ConstShapeView v,
           Turns turns, CornerPulls& out),
          (table, begin, count, v, turns, out))
ARAP_WIDE(FaceBends, FaceBendsWide,
          (const FaceTable& table, std::size_t begin, std::size_t count, ConstShapeView d,
           ConstTurns turns, KernelColumn& bend),
          (table, begin, count, d, turns, bend))

std::span<const Spoke> SpokesOfStar(const StarTable& table, std::size_t s) {
  return std::span(table.spokes).subspan(table.begin[s], table.begin[s + 1] - table.begin[s]);
}

Complex Along(ConstShapeView v, const Spoke& s) {
  return {v.x[s.b] - v.x[s.a], v.y[s.b] - v.y[s.a]};
}

// Σ w conj(e)(v_b − v_a)
Complex Similarity(std::span<const Spoke> star, ConstShapeView v) {
  Complex sum = 0;
  for (const Spoke& spoke : star) sum += spoke.weight * (std::conj(spoke.rest) * Along(v, spoke));
  return sum;
}

}  // namespace

RigidDescent::RigidDescent(const Cells& cells, bool wide)
    : cells_(cells),
      wide_(wide),
      face_x_(cells.faces.size()),
      face_y_(cells.faces.size()),
      face_inverse_(cells.faces.size()),
      star_x_(cells.stars.size()),
      star_y_(cells.stars.size()),
      star_inverse_(cells.stars.size()) {}

double RigidDescent::Pull(ConstShapeView v, ShapeView pull, std::size_t vertices) {
  std::fill_n(pull.x, vertices, 0.0);
  std::fill_n(pull.y, vertices, 0.0);
  const FaceTable& table = cells_.faces;
  const auto kernel = wide_ ? FacePullsWide : FacePulls;
  const Turns turns{face_x_.data(), face_y_.data(), face_inverse_.data()};
  CornerPulls p;  // NOLINT(*-member-init): written before it is read
  double energy = 0;
  for (std::size_t at = 0; at < table.size(); at += kKernelBlock) {
    const std::size_t count = std::min(kKernelBlock, table.size() - at);
    kernel(table, at, count, v, turns, p);
    energy = AddPulls(table, at, count, p, energy, pull);
  }
  return energy + PullStars(v, pull);
}

double RigidDescent::PullStars(ConstShapeView v, ShapeView pull) {
  const StarTable& table = cells_.stars;
  double energy = 0;
  for (std::size_t s = 0; s < table.size(); ++s) {
    const auto star = SpokesOfStar(table, s);
    const Complex sum = Similarity(star, v);
    const double length = std::sqrt(std::norm(sum));
    const bool turned = length > kNoDirection * table.size_of[s];
    const Complex turn = turned ? sum * (1 / length) : 1;
    star_x_[s] = turn.real();
    star_y_[s] = turn.imag();
    star_inverse_[s] = turned ? 1 / length : 0;
    for (const Spoke& spoke : star) {
      const Complex left = Along(v, spoke) - turn * spoke.rest;
      energy += spoke.weight * std::norm(left);
      pull.x[spoke.b] -= spoke.weight * left.real();
      pull.y[spoke.b] -= spoke.weight * left.imag();
      pull.x[spoke.a] += spoke.weight * left.real();
      pull.y[spoke.a] += spoke.weight * left.imag();
    }
  }
  return energy;
}

double RigidDescent::Bend(ConstShapeView d) const {
  const FaceTable& table = cells_.faces;
  const auto kernel = wide_ ? FaceBendsWide : FaceBends;
  const ConstTurns turns{face_x_.data(), face_y_.data(), face_inverse_.data()};
  KernelColumn bends;
  double bend = 0;
  for (std::size_t at = 0; at < table.size(); at += kKernelBlock) {
    const std::size_t count = std::min(kKernelBlock, table.size() - at);
    kernel(table, at, count, d, turns, bends);
    for (std::size_t k = 0; k < count; ++k) bend += bends[k];
  }
  return bend + BendStars(d);
}

double RigidDescent::BendStars(ConstShapeView d) const {
  const StarTable& table = cells_.stars;
  double bend = 0;
  for (std::size_t s = 0; s < table.size(); ++s) {
    const Complex turn(star_x_[s], star_y_[s]);
    const double own = (std::conj(turn) * Similarity(SpokesOfStar(table, s), d)).imag();
    bend += own * own * star_inverse_[s];
  }
  return bend;
}

}  // namespace arap
