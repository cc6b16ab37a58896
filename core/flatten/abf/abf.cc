#include "core/flatten/abf/abf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <fmt/format.h>

#include "core/base/try.h"
#include "core/mesh/space.h"
#include "core/sparse/factor.h"

namespace arap {
namespace {

// Steps end when no angle moves by more than this part of itself and the residual is as small.
constexpr double kSettled = 1e-7;
constexpr double kPi = std::numbers::pi;
// Targets stay this far from 0 and from a straight angle, relative to π.
constexpr double kAngleMargin = 1e-9;
// A step takes at most this part of a corner's distance to 0 or to π.
constexpr double kMaxStepToEnd = 0.9;
// What is left of the weight of a corner that would have gone too far. Without it crumpled surfaces
// jam, with the same few angles cut short in every step; a tenth makes later steps too timid.
constexpr double kStiffen = 0.25;

// Interior vertices numbered in order, kNone elsewhere. A joint of several pieces has no one wheel.
std::vector<std::uint32_t> InteriorNumbers(const Topology& topology,
                                           const std::vector<Triangle>& triangles,
                                           const std::vector<bool>& left_out, std::size_t& count) {
  std::vector<std::uint32_t> number(topology.vertex_component.size(), 0);
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (topology.vertex_component[v] == kNone) number[v] = kNone;
  }
  for (const Edge& edge : topology.edges) {
    if (edge.boundary()) number[edge.v0] = number[edge.v1] = kNone;
  }
  for (const std::uint32_t v : topology.joints) number[v] = kNone;
  for (std::size_t t = 0; t < left_out.size(); ++t) {
    if (!left_out[t]) continue;
    for (const std::uint32_t v : triangles[t]) number[v] = kNone;
  }
  std::uint32_t next = 0;
  for (std::uint32_t& n : number) {
    if (n != kNone) n = next++;
  }
  count = next;
  return number;
}

// The larger of the two; NaN when either is.
double Larger(double a, double b) { return b <= a ? a : std::isnan(a) ? a : b; }

// Moves a triangle's angles, all by the same part of `step`, so that their sum stays. A corner
// that the step would turn inside out is stiffer from now on. The largest relative change.
double Move(const Eigen::Vector3d& step, TriangleAngles& angles, TriangleAngles& freedom) {
  double part = 1, largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double change = step[static_cast<Eigen::Index>(k)];
    const double room = change < 0 ? angles[k] : kPi - angles[k];
    const double relative = std::abs(change) / angles[k];
    largest = Larger(largest, relative);
    if (std::abs(change) <= kMaxStepToEnd * room) continue;
    freedom[k] *= kStiffen;
    part = std::min(part, kMaxStepToEnd * room / std::abs(change));
  }
  for (std::size_t k = 0; k < 3; ++k) angles[k] += part * step[static_cast<Eigen::Index>(k)];
  return largest;
}

// The constrained least squares, one Newton step after another: minimises Σ ((α − β)/β)² under the
// constraints linearised at the present angles α, again and again; β are the targets. Rows 2i and
// 2i + 1 are the angle sum and the wheel of interior vertex i. The rows of the triangles are
// eliminated by hand: within a triangle the projected weights diag(w) − wwᵗ/Σw, w = β², are all
// that is left of them.
//
// Keeps references to the triangles. Not thread-safe.
class AngleSystem {
 public:
  // Around the corners of triangles in `left_out` (#F or empty) nothing has to fit.
  AngleSystem(const std::vector<Triangle>& triangles, const Topology& topology,
              const std::vector<bool>& left_out = {});

  // Interior vertices; without any, there is nothing to solve.
  std::size_t interior() const { return count_; }

  // Takes the angles of the surface as targets, scaled to sum to 2π around every interior vertex
  // and clamped to be those of a triangle. Answers them scaled to sum to π in every triangle: where
  // to start.
  std::vector<TriangleAngles> Target(std::vector<TriangleAngles> angles);

  // By row: 2π minus the angle sum, and minus the sum of log sines.
  std::vector<double> Residual(const std::vector<TriangleAngles>& angles) const;

  // One step from `angles`, which it replaces; answers the largest relative change that it wanted.
  // The angles stay in (0, π): a triangle that would turn a corner inside out goes only part of the
  // way, and that corner is stiffer from then on. Fault: kNumerical.
  Result<double> Step(std::vector<TriangleAngles>& angles);

 private:
  struct Local;
  Local At(std::size_t t, const TriangleAngles& angles) const;
  std::uint32_t Row(std::size_t t, int p) const;
  // Calls visit(triangle, corner, number of the interior vertex there).
  template <class Visit>
  void ForEachCorner(Visit visit) const;
  Eigen::SparseMatrix<double> Assemble(const std::vector<TriangleAngles>& angles,
                                       std::vector<double>& right);

  const std::vector<Triangle>& triangles_;
  std::size_t count_ = 0;
  std::vector<std::uint32_t> interior_;  // #V, kNone at other vertices
  std::vector<TriangleAngles> target_;   // β, #F
  std::vector<TriangleAngles> freedom_;  // factors of the weights, 1 unless stiffened, #F
  std::vector<Eigen::Triplet<double, int>> triplets_;
  std::vector<int> order_;  // the pattern is the same in every step
  Workspace workspace_;
};

// A triangle's share of the system.
struct AngleSystem::Local {
  Eigen::Matrix<double, 6, 3> rows;  // 2k: angle sum of corner k's vertex, 2k + 1: its wheel
  Eigen::Matrix3d weights;           // diag(w) − wwᵗ/Σw
  Eigen::Vector3d to_target;         // to the best angles that sum to π in this triangle
};

AngleSystem::AngleSystem(const std::vector<Triangle>& triangles, const Topology& topology,
                         const std::vector<bool>& left_out)
    : triangles_(triangles), interior_(InteriorNumbers(topology, triangles, left_out, count_)) {}

template <class Visit>
void AngleSystem::ForEachCorner(Visit visit) const {
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = interior_[triangles_[t][k]];
      if (i != kNone) visit(t, k, i);
    }
  }
}

std::vector<TriangleAngles> AngleSystem::Target(std::vector<TriangleAngles> angles) {
  std::vector<double> sum(count_, 0.0);
  ForEachCorner([&](std::size_t t, std::size_t k, std::uint32_t i) { sum[i] += angles[t][k]; });
  ForEachCorner(
      [&](std::size_t t, std::size_t k, std::uint32_t i) { angles[t][k] *= 2 * kPi / sum[i]; });
  for (TriangleAngles& a : angles) {
    for (double& angle : a) {
      angle = std::clamp(angle, kAngleMargin * kPi, (1 - kAngleMargin) * kPi);
    }
  }
  target_ = angles;
  freedom_.assign(angles.size(), {1, 1, 1});
  for (TriangleAngles& a : angles) {
    const double scale = kPi / (a[0] + a[1] + a[2]);
    for (double& angle : a) angle *= scale;
  }
  return angles;
}

std::vector<double> AngleSystem::Residual(const std::vector<TriangleAngles>& angles) const {
  std::vector<double> residual(2 * count_, 0.0);
  for (std::size_t i = 0; i < count_; ++i) residual[2 * i] = 2 * kPi;
  ForEachCorner([&](std::size_t t, std::size_t k, std::uint32_t i) {
    const TriangleAngles& a = angles[t];
    residual[2 * i] -= a[k];
    residual[2 * i + 1] -= std::log(std::sin(a[(k + 1) % 3])) - std::log(std::sin(a[(k + 2) % 3]));
  });
  return residual;
}

AngleSystem::Local AngleSystem::At(std::size_t t, const TriangleAngles& angles) const {
  Local local;
  local.rows.setZero();
  Eigen::Vector3d w, gap;
  double missing = kPi;
  for (int k = 0; k < 3; ++k) {
    const auto c = static_cast<std::size_t>(k);
    local.rows(2 * k, k) = 1;
    local.rows(2 * k + 1, (k + 1) % 3) = 1 / std::tan(angles[(c + 1) % 3]);
    local.rows(2 * k + 1, (k + 2) % 3) = -1 / std::tan(angles[(c + 2) % 3]);
    w[k] = freedom_[t][c] * target_[t][c] * target_[t][c];
    gap[k] = target_[t][c] - angles[c];
    missing -= target_[t][c];
  }
  local.weights = w.asDiagonal();
  local.weights -= w * w.transpose() / w.sum();
  local.to_target = gap + w * (missing / w.sum());
  return local;
}

std::uint32_t AngleSystem::Row(std::size_t t, int p) const {
  const std::uint32_t i = interior_[triangles_[t][static_cast<std::size_t>(p / 2)]];
  return i == kNone ? kNone : 2 * i + static_cast<std::uint32_t>(p % 2);
}

Eigen::SparseMatrix<double> AngleSystem::Assemble(const std::vector<TriangleAngles>& angles,
                                                  std::vector<double>& right) {
  triplets_.clear();
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Local local = At(t, angles[t]);
    const Eigen::Matrix<double, 6, 6> share = local.rows * local.weights * local.rows.transpose();
    const Eigen::Matrix<double, 6, 1> known = local.rows * local.to_target;
    for (int p = 0; p < 6; ++p) {
      const std::uint32_t row = Row(t, p);
      if (row == kNone) continue;
      right[row] -= known[p];
      for (int q = 0; q < 6; ++q) {
        const std::uint32_t column = Row(t, q);
        if (column == kNone || column > row) continue;
        triplets_.emplace_back(static_cast<int>(row), static_cast<int>(column), share(p, q));
      }
    }
  }
  const auto n = static_cast<Eigen::Index>(2 * count_);
  Eigen::SparseMatrix<double> lower(n, n);
  lower.setFromTriplets(triplets_.begin(), triplets_.end());
  return lower;
}

Result<double> AngleSystem::Step(std::vector<TriangleAngles>& angles) {
  std::vector<double> right = Residual(angles);
  const Eigen::SparseMatrix<double> lower = Assemble(angles, right);
  TRY(const auto factor, Factor<double>::Make(lower, FactorLayout::kSupernodal, order_));
  order_.assign(factor->order().begin(), factor->order().end());
  TRY(const auto lambda, factor->Solve(right, 1, workspace_));
  double largest = 0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Local local = At(t, angles[t]);
    Eigen::Vector3d pull = Eigen::Vector3d::Zero();
    for (int p = 0; p < 6; ++p) {
      const std::uint32_t row = Row(t, p);
      if (row != kNone) pull += lambda[row] * local.rows.row(p).transpose();
    }
    largest = Larger(largest, Move(local.to_target + local.weights * pull, angles[t], freedom_[t]));
  }
  if (!std::isfinite(largest)) {
    return Fail(FaultKind::kNumerical, "The flat angles are not finite.");
  }
  return largest;
}

Status CheckBoundaries(const Topology& topology) {
  std::vector<bool> open(topology.components, false);
  for (const Edge& edge : topology.edges) {
    if (edge.boundary()) open[topology.vertex_component[edge.v0]] = true;
  }
  const auto closed = std::find(open.begin(), open.end(), false);
  if (closed == open.end()) return {};
  const auto component = closed - open.begin();
  return Fail(Fault(FaultKind::kNotADisk,
                    fmt::format("Component {} is closed: it has no flat angles.", component))
                  .Field("mesh.triangles")
                  .Detail("component", component));
}

std::vector<TriangleAngles> AnglesOf(const SurfaceMesh& mesh, const std::vector<bool>& left_out) {
  std::vector<TriangleAngles> angles(mesh.triangles.size());
  for (std::size_t t = 0; t < angles.size(); ++t) {
    if (!left_out.empty() && left_out[t]) {
      angles[t].fill(std::numbers::pi / 3);
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto p = Vec(mesh.vertices[mesh.triangles[t][k]]);
      const Eigen::Vector3d a = Vec(mesh.vertices[mesh.triangles[t][(k + 1) % 3]]) - p;
      const Eigen::Vector3d b = Vec(mesh.vertices[mesh.triangles[t][(k + 2) % 3]]) - p;
      angles[t][k] = std::atan2(a.cross(b).norm(), a.dot(b));
    }
  }
  return angles;
}

double Largest(const std::vector<double>& values) {
  double largest = 0;
  for (const double v : values) largest = std::max(largest, std::abs(v));
  return largest;
}

}  // namespace

AngleResidual ResidualOf(const std::vector<Triangle>& triangles, const Topology& topology,
                         const std::vector<TriangleAngles>& angles) {
  AngleResidual worst;
  for (const TriangleAngles& a : angles) {
    worst.sum = std::max(worst.sum, std::abs(a[0] + a[1] + a[2] - std::numbers::pi));
  }
  const std::vector<double> rows = AngleSystem(triangles, topology).Residual(angles);
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    worst.sum = std::max(worst.sum, std::abs(rows[i]));
    worst.wheel = std::max(worst.wheel, std::abs(rows[i + 1]));
  }
  return worst;
}

Result<std::vector<TriangleAngles>> FlatAngles(const SurfaceMesh& mesh, const Topology& topology,
                                               const CancelToken& cancel, int steps,
                                               const std::vector<bool>& left_out) {
  if (steps < 1 || steps > kMaxAngleSteps) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("steps is {}; it must be 1 to {}.", steps, kMaxAngleSteps))
                    .Field("steps")
                    .Detail("limit", kMaxAngleSteps));
  }
  CHECK_OK(CheckBoundaries(topology));
  AngleSystem system(mesh.triangles, topology, left_out);
  std::vector<TriangleAngles> angles = system.Target(AnglesOf(mesh, left_out));
  if (system.interior() == 0) return angles;
  std::vector<TriangleAngles> best;
  double least = std::numeric_limits<double>::infinity();
  for (int step = 0; step < steps; ++step) {
    CHECK_OK(cancel.Check());
    const auto change = system.Step(angles);
    if (!change) {
      // Where nothing fits, later steps may meet a singular system.
      if (best.empty()) return Fail(change.error());
      break;
    }
    const double residual = Largest(system.Residual(angles));
    if (residual < least) least = residual, best = angles;
    if (*change < kSettled && residual < kSettled) break;
  }
  if (best.empty()) return Fail(FaultKind::kNumerical, "The flat angles are not finite.");
  return best;
}

std::array<Complex, 3> FrameOfAngles(const TriangleAngles& angles, double length) {
  const double side = length * std::sin(angles[1]) / std::sin(angles[2]);
  return {Complex(0), Complex(length), std::polar(side, angles[0])};
}

}  // namespace arap
