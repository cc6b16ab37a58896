#include "core/flatten/abf/angle_system.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

namespace arap {
namespace {

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

}  // namespace

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
  auto factor = Factor<double>::Make(lower, FactorLayout::kSupernodal, order_);
  if (!factor) return Fail(std::move(factor.error()));
  order_.assign((*factor)->order().begin(), (*factor)->order().end());
  const auto lambda = (*factor)->Solve(right, 1, workspace_);
  if (lambda.empty()) {
    return Fail(FaultKind::kNumerical, "a back-substitution ran out of memory");
  }
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
    return Fail(FaultKind::kNumerical, "the flat angles are not finite");
  }
  return largest;
}

}  // namespace arap
