#include "core/cut/chart.h"

#include <fmt/format.h>

#include "core/mesh/topology.h"
#include "core/mesh/union_find.h"

namespace arap {

std::string Chart::Describe() const {
  if (closed()) return genus == 0 ? "closed" : fmt::format("closed, of genus {}", genus);
  return fmt::format("of genus {} with {} {}", genus, boundary_starts.size(),
                     boundary_starts.size() == 1 ? "boundary" : "boundaries");
}

std::vector<Chart> FindCharts(std::size_t vertex_count, std::span<const Triangle> triangles,
                              const Gluing& gluing) {
  UnionFind sets(triangles.size());
  for (std::uint32_t side = 0; side < gluing.mate.size(); ++side) {
    if (!gluing.open(side)) sets.Join(side / 3, gluing.mate[side] / 3);
  }
  std::vector<Chart> charts;
  std::vector<std::uint32_t> chart_of(triangles.size());
  std::vector<bool> vertex_seen(vertex_count, false), side_seen(gluing.mate.size(), false);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t root = sets.Find(t);
    if (root == t) charts.emplace_back();
    chart_of[t] = root == t ? static_cast<std::uint32_t>(charts.size() - 1) : chart_of[root];
    Chart& chart = charts[chart_of[t]];
    chart.triangles.push_back(t);
    // Euler characteristic V − E + F, with E = (3F + open sides) / 2; here −(F + open sides).
    chart.euler -= 1;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[t][k], side = 3 * t + k;
      if (!vertex_seen[v]) chart.vertices.push_back(v);
      vertex_seen[v] = true;
      if (!gluing.open(side)) continue;
      chart.euler -= 1;
      if (side_seen[side]) continue;
      chart.boundary_starts.push_back(side);
      for (std::uint32_t s = side; !side_seen[s]; s = gluing.NextOpen(s)) side_seen[s] = true;
    }
  }
  for (Chart& chart : charts) {
    chart.euler = (chart.euler + 2 * static_cast<std::int64_t>(chart.vertices.size())) / 2;
    chart.genus = (2 - static_cast<std::int64_t>(chart.boundary_starts.size()) - chart.euler) / 2;
  }
  return charts;
}

}  // namespace arap
