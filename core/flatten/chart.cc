#include "core/flatten/chart.h"

#include <algorithm>
#include <cmath>

#include "core/base/try.h"
#include "core/cut/pieces.h"
#include "core/flatten/distortion.h"
#include "core/mesh/space.h"

namespace arap {
namespace {

// The sides of a triangle without area grow by this part of the longest before it is laid flat: a
// sliver of the right lengths.
constexpr double kSliver = 1e-6;

std::array<Complex, 3> SliverFrame(const SurfaceMesh& mesh, const Triangle& t) {
  std::array<double, 3> side;  // opposite corner k
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

void LayTrianglesFlat(const CutSurface& surface, Chart& chart) {
  chart.frames.reserve(chart.mesh.triangles.size());
  for (std::size_t t = 0; t < chart.mesh.triangles.size(); ++t) {
    const bool degenerate = std::binary_search(surface.degenerate.begin(), surface.degenerate.end(),
                                               chart.triangles[t]);
    if (degenerate && chart.left_out.empty()) {
      chart.left_out.resize(chart.mesh.triangles.size());
    }
    if (degenerate) chart.left_out[t] = true;
    chart.frames.push_back(degenerate ? SliverFrame(chart.mesh, chart.mesh.triangles[t])
                                      : LayFlat(chart.mesh, chart.mesh.triangles[t]));
  }
}

}  // namespace

Result<CellSystem> Chart::Cells(const EnergyOptions& options,
                                const std::vector<std::array<Complex, 3>>& flat) const {
  const TriangleFrame frame = [&flat](std::uint32_t t) { return flat[t]; };
  return BuildCells(mesh.triangles, topology, options, frame, false, left_out);
}

Result<std::vector<Chart>> MakeCharts(const CutSurface& surface, const CancelToken& cancel) {
  // Components by their lowest triangle.
  std::vector<std::uint32_t> chart_of(surface.topology.components, kNone);
  std::vector<Chart> charts;
  std::vector<std::uint32_t> local(surface.mesh.vertices.size(), kNone);
  for (std::uint32_t t = 0; t < surface.mesh.triangles.size(); ++t) {
    const Triangle& corners = surface.mesh.triangles[t];
    std::uint32_t& index = chart_of[surface.topology.vertex_component[corners[0]]];
    if (index == kNone) {
      index = static_cast<std::uint32_t>(charts.size());
      charts.emplace_back();
    }
    charts[index].triangles.push_back(t);
  }
  // Vertices keep their order, so that a surface of one chart keeps its numbers.
  for (std::uint32_t v = 0; v < surface.mesh.vertices.size(); ++v) {
    const std::uint32_t component = surface.topology.vertex_component[v];
    if (component == kNone) continue;
    Chart& chart = charts[chart_of[component]];
    local[v] = static_cast<std::uint32_t>(chart.vertices.size());
    chart.vertices.push_back(v);
    chart.mesh.vertices.push_back(surface.mesh.vertices[v]);
  }
  for (Chart& chart : charts) {
    CHECK_OK(cancel.Check());
    chart.mesh.triangles.reserve(chart.triangles.size());
    for (const std::uint32_t t : chart.triangles) {
      const Triangle& c = surface.mesh.triangles[t];
      chart.mesh.triangles.push_back({local[c[0]], local[c[1]], local[c[2]]});
    }
    Normalise(chart);
    // A chart that is all of the surface has the same numbers.
    const bool whole = chart.vertices.size() == surface.mesh.vertices.size();
    chart.topology =
        whole ? surface.topology : BuildTopology(chart.mesh.vertices.size(), chart.mesh.triangles);
    for (BoundaryLoop& loop : BoundaryLoops(chart.mesh, chart.topology)) {
      chart.loops.push_back(std::move(loop.vertices));
    }
    LayTrianglesFlat(surface, chart);
  }
  return charts;
}

}  // namespace arap
