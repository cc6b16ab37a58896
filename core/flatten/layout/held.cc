#include "core/flatten/layout/held.h"

#include <limits>

#include "core/mesh/space.h"

namespace arap {
namespace {

// Symmetric surfaces have several places at one distance; rounding must not choose among them.
constexpr double kTie = 1e-9;
// Part of the diagonal below which an edge has no direction.
constexpr double kNoLength = 1e-9;

Eigen::Vector3d Centroid(const SurfaceMesh& mesh) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Point3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double weight = TwiceArea(a, b, c);
    centroid += weight / 3 * (Vec(a) + Vec(b) + Vec(c));
    area += weight;
  }
  return centroid / area;
}

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

std::array<std::uint32_t, 2> CentreEdge(const Chart& chart) {
  const SurfaceMesh& mesh = chart.mesh;
  const Eigen::Vector3d centroid = Centroid(mesh);
  const Edge* best = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Edge& edge : chart.topology.edges) {
    const auto a = Vec(mesh.vertices[edge.v0]), b = Vec(mesh.vertices[edge.v1]);
    if ((b - a).squaredNorm() < kNoLength * kNoLength) continue;
    const double distance = (0.5 * (a + b) - centroid).squaredNorm();
    if (distance < nearest - kTie) best = &edge, nearest = distance;
  }
  if (best == nullptr) best = &chart.topology.edges.front();
  return {best->v0, best->v1};
}

std::array<std::uint32_t, 2> FarBoundaryPair(const Chart& chart) {
  const std::uint32_t a = FarthestOnBoundary(chart, Centroid(chart.mesh), kNone);
  return {a, FarthestOnBoundary(chart, Vec(chart.mesh.vertices[a]), a)};
}

Held HoldAtDistance(const Chart& chart, const std::array<std::uint32_t, 2>& anchors) {
  const auto& p = chart.mesh.vertices;
  return {{{anchors[0], 0, 0}, {anchors[1], (Vec(p[anchors[1]]) - Vec(p[anchors[0]])).norm(), 0}}};
}

}  // namespace arap
