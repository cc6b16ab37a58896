#include "client/cli/answers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <fmt/format.h>

namespace arap::cli {
namespace {

bool IsFinite(std::span<const Complex> points) {
  return std::all_of(points.begin(), points.end(),
                     [](Complex p) { return std::isfinite(p.real()) && std::isfinite(p.imag()); });
}

bool Below(std::span<const std::uint32_t> indices, std::size_t count) {
  return std::all_of(indices.begin(), indices.end(),
                     [count](std::uint32_t i) { return i < count; });
}

template <std::size_t kCount>
bool AllBelow(const std::vector<std::array<std::uint32_t, kCount>>& groups, std::size_t count) {
  return std::all_of(groups.begin(), groups.end(),
                     [count](const auto& group) { return Below(group, count); });
}

// Every corner of a flat triangle is a copy of the corner of the mesh.
bool CopiesCorners(const Flattening& flat, const SurfaceMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (flat.source[flat.corner_uv[t][k]] != mesh.triangles[t][k]) return false;
    }
  }
  return true;
}

}  // namespace

Status CheckShape(const client::Shape& shape, std::size_t vertices) {
  if (shape.positions.size() != vertices) {
    return Fail(FaultKind::kInternal,
                fmt::format("The server answered a shape of {} vertices; the mesh has {}.",
                            shape.positions.size(), vertices));
  }
  if (!IsFinite(shape.positions)) {
    return Fail(FaultKind::kInternal,
                "The server answered a shape with a position that is not finite.");
  }
  return {};
}

Status CheckLayout(const Flattening& flat, const SurfaceMesh& mesh) {
  const std::size_t positions = flat.uv.size();
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  bool good = flat.source.size() == positions && flat.corner_uv.size() == triangles &&
              flat.singular_values.size() == triangles && flat.triangle_chart.size() == triangles;
  good = good && IsFinite(flat.uv) && Below(flat.source, vertices);
  good = good && AllBelow(flat.corner_uv, positions) && CopiesCorners(flat, mesh);
  good = good && AllBelow(flat.cuts, vertices) && Below(flat.degenerate, triangles);
  good = good && Below(flat.triangle_chart, flat.charts.size());
  for (const FlatChart& chart : flat.charts) {
    for (const auto& loop : chart.loops) good = good && Below(loop, positions);
    good = good && Below(chart.anchors, positions);
  }
  if (good) return {};
  return Fail(FaultKind::kInternal, "The server answered a layout that does not fit the mesh.");
}

}  // namespace arap::cli
