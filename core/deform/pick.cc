#include "arap/core/pick.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/deform/registered_parts.h"
#include "core/mesh/plane.h"

namespace arap {

std::vector<double> VertexDepths(const CompiledHandles& handles) {
  const RegisteredMeshParts& mesh = handles.mesh()->parts();
  std::vector<double> depths;
  for (const PlacedHandle& placed : handles.handles()) {
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

std::vector<std::uint32_t> DrawOrder(const CompiledHandles& handles) {
  const std::vector<double> depths = VertexDepths(handles);
  if (depths.empty()) return {};
  const auto& triangles = handles.mesh()->mesh().triangles;
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

Picker::Picker(std::shared_ptr<const CompiledHandles> handles)
    : handles_(std::move(handles)), depths_(VertexDepths(*handles_)) {}

std::optional<Pick> Picker::Find(std::span<const Complex> positions, Complex point) const {
  const RegisteredMeshParts& mesh = handles_->mesh()->parts();
  const auto& triangles = mesh.mesh.triangles;
  std::optional<Pick> best;
  double highest = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto found = Locate(positions, std::span(triangles).subspan(t, 1), point);
    if (!found) continue;
    double depth = 0;
    Pick pick{t, found->barycentric, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangles[t][k];
      if (!depths_.empty()) depth += pick.barycentric[k] * depths_[v];
      pick.rest += pick.barycentric[k] * mesh.mesh.vertices[v];
    }
    if (best && depth <= highest) continue;
    if (mesh.turned[t]) std::swap(pick.barycentric[1], pick.barycentric[2]);
    best = pick;
    highest = depth;
    if (depths_.empty()) break;  // the lowest index it is
  }
  return best;
}

}  // namespace arap
