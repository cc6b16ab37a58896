// Held: the vertices of one chart that are kept at places of the plane; and anchors, the two that
// fix the free similarity of the first step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "arap/model/mesh.h"
#include "core/flatten/chart.h"

namespace arap {

struct HeldVertex {
  std::uint32_t vertex = 0;  // of the chart
  Complex uv;                // in units of the chart
  double weight = 0;         // 0: exactly
};

// Either at least two pins that are not on one spot, or two anchors, or nothing.
struct Held {
  std::vector<HeldVertex> vertices;

  bool empty() const { return vertices.empty(); }
  // Of a vertex: how far it gives way to a unit of force.
  static double Compliance(const HeldVertex& held) {
    return held.weight == 0 ? 0 : 1 / held.weight;
  }
  // #V: whether a vertex is held exactly.
  std::vector<bool> Fixed(std::size_t vertex_count) const {
    std::vector<bool> fixed(vertex_count);
    for (const HeldVertex& held : vertices) fixed[held.vertex] = held.weight == 0;
    return fixed;
  }
};

// The boundary vertex farthest from the centroid and the one farthest from that. Never the
// quadratic search for the farthest pair.
std::array<std::uint32_t, 2> FarBoundaryPair(const Chart& chart);

// The first at 0, the second at their distance in space on the real axis.
Held HoldAtDistance(const Chart& chart, const std::array<std::uint32_t, 2>& anchors);

}  // namespace arap
