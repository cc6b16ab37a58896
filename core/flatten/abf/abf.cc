#include "core/flatten/abf/abf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "core/flatten/abf/angle_system.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

// Steps end when no angle moves by more than this part of itself and the residual is as small.
constexpr double kSettled = 1e-7;

Status CheckBoundaries(const Topology& topology) {
  std::vector<bool> open(topology.components, false);
  for (const Edge& edge : topology.edges) {
    if (edge.boundary()) open[topology.vertex_component[edge.v0]] = true;
  }
  const auto closed = std::find(open.begin(), open.end(), false);
  if (closed == open.end()) return {};
  const auto component = closed - open.begin();
  return Fail(Fault(FaultKind::kNotADisk,
                    fmt::format("component {} is closed: it has no flat angles", component))
                  .Field("mesh.triangles")
                  .Detail("component", fmt::to_string(component)));
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
                      fmt::format("steps is {}; it must be 1 to {}", steps, kMaxAngleSteps))
                    .Field("steps")
                    .Detail("limit", fmt::to_string(kMaxAngleSteps)));
  }
  if (auto ok = CheckBoundaries(topology); !ok) return Fail(std::move(ok.error()));
  AngleSystem system(mesh.triangles, topology, left_out);
  std::vector<TriangleAngles> angles = system.Target(AnglesOf(mesh, left_out));
  if (system.interior() == 0) return angles;
  std::vector<TriangleAngles> best;
  double least = std::numeric_limits<double>::infinity();
  for (int step = 0; step < steps; ++step) {
    if (auto ok = cancel.Check(); !ok) return Fail(std::move(ok.error()));
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
  if (best.empty()) return Fail(FaultKind::kNumerical, "the flat angles are not finite");
  return best;
}

std::array<Complex, 3> FrameOfAngles(const TriangleAngles& angles, double length) {
  const double side = length * std::sin(angles[1]) / std::sin(angles[2]);
  return {Complex(0), Complex(length), std::polar(side, angles[0])};
}

}  // namespace arap
