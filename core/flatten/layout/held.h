// Held: the vertices of one chart that are kept at places of the plane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "arap/model/mesh.h"

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

}  // namespace arap
