#include "core/flatten/layout/held.h"

#include "core/mesh/space.h"

namespace arap {
namespace {

// Symmetric surfaces have several places at one distance; rounding must not choose among them.
constexpr double kTie = 1e-9;

// The boundary vertex farthest from `from`, other than `not_this`.
std::uint32_t FarthestOnBoundary(const Chart& chart, const Eigen::Vector3d& from,
                                 std::uint32_t not_this) {
  std::uint32_t best = kNone;
  double farthest = 0;
  for (const auto& loop : chart.loops) {
    for (const std::uint32_t v : loop) {
      const double distance = (Vec(chart.mesh.vertices[v]) - from).squaredNorm();
      if (v == not_this) continue;
      if (best == kNone || distance > farthest * (1 + kTie)) best = v, farthest = distance;
    }
  }
  return best;
}

}  // namespace

std::array<std::uint32_t, 2> FarBoundaryPair(const Chart& chart) {
  const std::uint32_t a = FarthestOnBoundary(chart, AreaCentroid(chart.mesh), kNone);
  return {a, FarthestOnBoundary(chart, Vec(chart.mesh.vertices[a]), a)};
}

Held HoldAtDistance(const Chart& chart, const std::array<std::uint32_t, 2>& anchors) {
  const auto& p = chart.mesh.vertices;
  return {{{anchors[0], 0, 0}, {anchors[1], (Vec(p[anchors[1]]) - Vec(p[anchors[0]])).norm(), 0}}};
}

}  // namespace arap
