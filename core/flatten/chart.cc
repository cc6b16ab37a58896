#include "core/flatten/chart.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/try.h"
#include "core/cut/pieces.h"
#include "core/flatten/distortion.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

// The sides of a triangle without area grow by this part of the longest before it is laid flat: a
// sliver of the right lengths.
constexpr double kSliver = 1e-6;

// Symmetric surfaces have several edges at one distance; rounding must not choose among them.
constexpr double kEqualDistances = 1e-9;
// Part of the diagonal below which an edge has no direction.
constexpr double kNoLength = 1e-9;

std::array<Complex, 3> SliverFrame(const SurfaceMesh& mesh, const Triangle& t) {
  std::array<double, 3> side{};  // opposite corner k
  for (std::size_t k = 0; k < 3; ++k) {
    side[k] = (Vec(mesh.vertices[t[(k + 2) % 3]]) - Vec(mesh.vertices[t[(k + 1) % 3]])).norm();
  }
  double longest = *std::max_element(side.begin(), side.end());
  if (!(longest > 0)) longest = kSliver;  // all corners on one spot; the diagonal is 1
  for (double& s : side) s += kSliver * longest;
  const double a = side[0], b = side[1], c = side[2];
  const double x = (c * c + b * b - a * a) / (2 * c);
  const double product = (a + b + c) * (a + b - c) * (a + c - b) * (b + c - a);
  return {Complex(0), Complex(c), Complex(x, std::sqrt(product) / (2 * c))};
}

void Normalise(Chart& chart) {
  Eigen::Vector3d low = Vec(chart.mesh.vertices.front()), high = low;
  for (const Point3& p : chart.mesh.vertices) {
    low = low.cwiseMin(Vec(p));
    high = high.cwiseMax(Vec(p));
  }
  chart.diagonal = (high - low).norm();
  for (Point3& p : chart.mesh.vertices) {
    p = ToPoint3((Vec(p) - 0.5 * (low + high)) / chart.diagonal);
  }
}

void LeaveOut(const std::vector<std::uint32_t>& degenerate, Chart& chart) {
  if (degenerate.empty()) return;
  for (std::size_t t = 0; t < chart.triangles.size(); ++t) {
    if (!std::binary_search(degenerate.begin(), degenerate.end(), chart.triangles[t])) continue;
    if (chart.left_out.empty()) chart.left_out.resize(chart.triangles.size());
    chart.left_out[t] = true;
  }
}

// Shares vertices and triangles out among the charts, which are empty yet.
void Distribute(CutSurface& surface, std::vector<Chart>& charts) {
  std::vector<Triangle>& triangles = surface.mesh.triangles;
  std::vector<std::uint32_t> chart_of(surface.mesh.vertices.size(), kNone);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    charts[surface.chart_of[t]].triangles.push_back(t);
    for (const std::uint32_t v : triangles[t]) chart_of[v] = surface.chart_of[t];
  }
  // Vertices keep their order, so that a surface of one chart keeps its numbers.
  std::vector<std::uint32_t> local(surface.mesh.vertices.size(), kNone);
  for (std::uint32_t v = 0; v < chart_of.size(); ++v) {
    if (chart_of[v] == kNone) continue;
    Chart& chart = charts[chart_of[v]];
    local[v] = static_cast<std::uint32_t>(chart.vertices.size());
    chart.vertices.push_back(v);
    chart.mesh.vertices.push_back(surface.mesh.vertices[v]);
  }
  for (Chart& chart : charts) {
    chart.mesh.triangles.reserve(chart.triangles.size());
    for (const std::uint32_t t : chart.triangles) {
      const Triangle& c = triangles[t];
      chart.mesh.triangles.push_back({local[c[0]], local[c[1]], local[c[2]]});
    }
  }
}

bool AllUsed(const SurfaceMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t v : t) used[v] = true;
  }
  return std::find(used.begin(), used.end(), false) == used.end();
}

}  // namespace

std::array<std::uint32_t, 2> CentreEdge(const SurfaceMesh& mesh, std::span<const Side> sides) {
  const Eigen::Vector3d centroid = AreaCentroid(mesh);
  const Side* best = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  ForEachEdge(sides, [&](std::span<const Side> edge) {
    const auto a = Vec(mesh.vertices[edge[0].v0]), b = Vec(mesh.vertices[edge[0].v1]);
    if ((b - a).squaredNorm() < kNoLength * kNoLength) return;
    const double distance = (0.5 * (a + b) - centroid).squaredNorm();
    if (distance < nearest - kEqualDistances) best = &edge[0], nearest = distance;
  });
  if (best == nullptr) best = &sides.front();
  return {best->v0, best->v1};
}

std::array<Complex, 3> Chart::Frame(std::uint32_t t) const {
  const bool sliver = !left_out.empty() && left_out[t];
  return sliver ? SliverFrame(mesh, mesh.triangles[t]) : LayFlat(mesh, mesh.triangles[t]);
}

Result<CellSystem> Chart::Cells(const EnergyOptions& options) const {
  const TriangleFrame frame = [this](std::uint32_t t) { return Frame(t); };
  return BuildCells(mesh.triangles, topology, options, frame, false, left_out);
}

Result<CellSystem> Chart::Cells(const EnergyOptions& options,
                                const std::vector<std::array<Complex, 3>>& flat) const {
  const TriangleFrame frame = [&flat](std::uint32_t t) { return flat[t]; };
  return BuildCells(mesh.triangles, topology, options, frame, false, left_out);
}

Result<std::vector<Chart>> MakeCharts(CutSurface& surface, bool edges, const CancelToken& cancel) {
  std::vector<Chart> charts(surface.charts);
  std::vector<Side> sides;  // of the chart
  if (charts.size() == 1 && AllUsed(surface.mesh)) {
    // It is all of the surface and has the same numbers.
    Chart& chart = charts.front();
    sides = std::move(surface.sides);
    chart.mesh = std::move(surface.mesh);
    chart.vertices.resize(chart.mesh.vertices.size());
    std::iota(chart.vertices.begin(), chart.vertices.end(), 0u);
    chart.triangles.resize(chart.mesh.triangles.size());
    std::iota(chart.triangles.begin(), chart.triangles.end(), 0u);
  } else {
    surface.sides = {};  // of triangles that are no more
    Distribute(surface, charts);
  }
  surface.mesh = {};
  surface.sides = {};
  surface.chart_of = {};
  for (Chart& chart : charts) {
    CHECK_OK(cancel.Check());
    Normalise(chart);
    const std::size_t vertices = chart.mesh.vertices.size();
    if (sides.empty()) sides = SortedSides(vertices, chart.mesh.triangles);
    chart.centre = CentreEdge(chart.mesh, sides);
    if (edges) chart.topology = BuildTopology(vertices, chart.mesh.triangles, sides);
    for (BoundaryLoop& loop : BoundaryLoops(chart.mesh, sides)) {
      chart.loops.push_back(std::move(loop.vertices));
    }
    sides.clear();
    LeaveOut(surface.degenerate, chart);
  }
  return charts;
}

}  // namespace arap
