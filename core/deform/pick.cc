#include "arap/core/pick.h"

#include <algorithm>

#include "arap/core/depth_order.h"
#include "core/deform/registered_parts.h"
#include "core/mesh/plane.h"

namespace arap {

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
