// Depth and drawing order of a handle set: CompiledHandles::VertexDepths and DrawOrder.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/deform/compiled_parts.h"

namespace arap {

std::vector<double> CompiledHandles::VertexDepths() const {
  const RegisteredMeshParts& mesh = parts_->mesh->parts();
  std::vector<double> depths;
  for (const PlacedHandle& placed : parts_->handles) {
    if (placed.handle.depth == 0) continue;
    depths.resize(mesh.rest.size(), 0);
    for (std::size_t v = 0; v < depths.size(); ++v) {
      if (mesh.topology.vertex_component[v] != placed.component) continue;
      const double reach = placed.handle.depth_falloff;
      const double distance = std::abs(mesh.mesh.vertices[v] - placed.rest);
      // Linear to nothing at the reach; several handles add up.
      const double share = reach == 0 ? 1 : std::max(0.0, 1 - distance / reach);
      depths[v] += placed.handle.depth * share;
    }
  }
  return depths;
}

std::vector<std::uint32_t> CompiledHandles::DrawOrder() const {
  const std::vector<double> depths = VertexDepths();
  if (depths.empty()) return {};
  const auto& triangles = parts_->mesh->parts().mesh.triangles;
  std::vector<double> key(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const std::uint32_t v : triangles[t]) key[t] += depths[v] / 3;
  }
  std::vector<std::uint32_t> order(triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
  return order;
}

}  // namespace arap
