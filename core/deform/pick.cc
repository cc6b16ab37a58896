#include "arap/core/pick.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <variant>

#include "core/base/try.h"
#include "core/base/wide.h"
#include "core/deform/compiled_parts.h"
#include "core/deform/registered_parts.h"
#include "core/mesh/locate.h"

namespace arap {
namespace {

// The depth that one handle adds, over the vertices of its component.
struct DepthCone {
  double x, y;     // the handle at rest, normalised
  double inverse;  // 1 / reach; 0: it does not fade
  double depth;
  std::uint32_t component;
};

ARAP_WIDE_BODY void AddCone(const DepthCone& cone, const double* points,
                            const std::uint32_t* components, std::size_t count, double* depths) {
#pragma GCC ivdep
  for (std::size_t v = 0; v < count; ++v) {
    const double dx = points[2 * v] - cone.x, dy = points[2 * v + 1] - cone.y;
    const double left = 1 - std::sqrt(dx * dx + dy * dy) * cone.inverse;
    const double share = left > 0 ? left : 0;
    depths[v] += components[v] == cone.component ? cone.depth * share : 0;
  }
}

ARAP_WIDE(AddCone, AddConeWide,
          (const DepthCone& cone, const double* points, const std::uint32_t* components,
           std::size_t count, double* depths),
          (cone, points, components, count, depths))

}  // namespace

Result<std::vector<double>> ComputeDepths(const RegisteredMeshParts& mesh,
                                          std::span<const PlacedHandle> handles,
                                          const CancelToken& cancel) {
  std::vector<double> depths;
  for (const PlacedHandle& placed : handles) {
    if (placed.handle.depth == 0) continue;
    CHECK_OK(cancel.Check());
    depths.resize(mesh.rest.size(), 0);
    const Complex rest = mesh.Normalise(placed.rest);
    // A reach that is nothing against the mesh still divides.
    const double reach = std::max(placed.handle.depth_falloff / mesh.report.diagonal, 1e-300);
    const double inverse = placed.handle.depth_falloff == 0 ? 0 : 1 / reach;
    const DepthCone cone{rest.real(), rest.imag(), inverse, placed.handle.depth, placed.component};
    // A complex number is two doubles in a row, says the standard.
    (HasWide() ? AddConeWide : AddCone)(cone, reinterpret_cast<const double*>(mesh.rest.data()),
                                        mesh.topology.vertex_component.data(), depths.size(),
                                        depths.data());
  }
  if (!depths.empty() && mesh.repair.changed()) {
    for (std::uint32_t v = 0; v < depths.size(); ++v) depths[v] = depths[mesh.repair.vertex[v]];
  }
  return depths;
}

std::span<const double> VertexDepths(const CompiledHandles& handles) {
  return handles.parts().depths;
}

std::vector<std::uint32_t> DrawOrder(const CompiledHandles& handles) {
  const std::span<const double> depths = VertexDepths(handles);
  if (depths.empty()) return {};
  const RegisteredMeshParts& mesh = handles.mesh()->parts();
  const auto& triangles = mesh.repair.changed() ? mesh.repair.given : mesh.mesh.triangles;
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

std::vector<std::optional<std::uint32_t>> TrianglesUnder(const RegisteredMesh& mesh,
                                                         std::span<const PlacedHandle> handles) {
  const PlanarMesh& rest = mesh.mesh();
  const Repair& repair = mesh.parts().repair;
  TriangleFinder finder(mesh.parts().nearby, rest.vertices, rest.triangles);
  const auto under = [&](const PlacedHandle& handle) -> std::optional<std::uint32_t> {
    if (const auto* vertex = std::get_if<VertexAnchor>(&handle.handle.anchor)) {
      const std::uint32_t triangle = finder.Of(repair.VertexOf(vertex->vertex));
      return triangle == kNone ? std::nullopt : std::optional(triangle);
    }
    const auto* triangle = std::get_if<TriangleAnchor>(&handle.handle.anchor);
    if (triangle != nullptr && !repair.changed()) {
      return triangle->triangle;
    }
    // The wider tolerance is for points on the boundary.
    for (const double tolerance : {kLocateTolerance, 1e-4}) {
      if (const auto found = finder.At(handle.rest, tolerance)) return found->triangle;
    }
    return std::nullopt;
  };
  std::vector<std::optional<std::uint32_t>> triangles;
  triangles.reserve(handles.size());
  for (const PlacedHandle& handle : handles) triangles.push_back(under(handle));
  return triangles;
}

Result<std::vector<std::optional<Pick>>> FindPicks(const CompiledHandles& handles,
                                                   std::span<const Complex> positions,
                                                   std::span<const Complex> points,
                                                   const CancelToken& cancel) {
  std::vector<std::optional<Pick>> picks(points.size());
  if (points.empty()) return picks;
  const RegisteredMeshParts& mesh = handles.mesh()->parts();
  const std::span<const Triangle> triangles = mesh.mesh.triangles;
  const std::span<const double> depths = VertexDepths(handles);
  const TriangleBoxes boxes(mesh.nearby, positions, triangles, depths);
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK_OK(cancel.Check());
    std::optional<Pick>& best = picks[i];
    double highest = 0;
    const auto wanted = [&](const TriangleBox& box) {
      if (!box.Holds(points[i])) return false;
      if (!best) return true;
      // The depth at a point is a rounded mean of those of the corners.
      const double most = box.highest + 1e-12 * std::abs(box.highest);
      return most > highest || (most == highest && box.lowest < best->triangle);
    };
    boxes.ForEach(wanted, [&](std::uint32_t t) {
      if (!wanted(BoxOf(positions, triangles, t, depths))) return;
      const auto found = LocateIn(positions, triangles, t, points[i]);
      if (!found) return;
      double depth = 0;
      Pick pick{t, found->barycentric, 0};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = triangles[t][k];
        if (!depths.empty()) depth += pick.barycentric[k] * depths[v];
        pick.rest += pick.barycentric[k] * mesh.mesh.vertices[v];
      }
      if (best && (depth < highest || (depth == highest && t > best->triangle))) return;
      best = pick;
      highest = depth;
    });
    if (!best) continue;
    const Located given = ToGiven(mesh, {best->triangle, best->barycentric, 0});
    best->triangle = given.triangle;
    best->barycentric = given.barycentric;
  }
  return picks;
}

}  // namespace arap
