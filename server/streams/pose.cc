#include "server/streams/pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <variant>

#include "core/mesh/locate.h"
#include "server/streams/targets.h"

namespace arap::app {
namespace {

using Corners = std::array<Complex, 3>;

Corners CornersOf(std::span<const Complex> points, const Triangle& triangle) {
  return {points[triangle[0]], points[triangle[1]], points[triangle[2]]};
}

// The first triangle that has the vertex; none for an unreferenced one.
std::optional<std::size_t> TriangleAt(const PlanarMesh& mesh, std::uint32_t vertex) {
  const auto found = std::find_if(
      mesh.triangles.begin(), mesh.triangles.end(),
      [&](const Triangle& t) { return std::find(t.begin(), t.end(), vertex) != t.end(); });
  if (found == mesh.triangles.end()) return std::nullopt;
  return static_cast<std::size_t>(found - mesh.triangles.begin());
}

// The triangle that the core finds for the point; the wider tolerance is for points on the
// boundary.
std::optional<std::size_t> TriangleAt(const PlanarMesh& mesh, Complex point) {
  for (const double tolerance : {1e-9, 1e-4}) {
    if (const auto found = Locate(mesh.vertices, mesh.triangles, point, tolerance)) {
      return found->triangle;
    }
  }
  return std::nullopt;
}

std::optional<std::size_t> TriangleOf(const PlanarMesh& mesh, const PlacedHandle& handle) {
  if (const auto* vertex = std::get_if<VertexAnchor>(&handle.handle.anchor)) {
    return TriangleAt(mesh, vertex->vertex);
  }
  if (const auto* triangle = std::get_if<TriangleAnchor>(&handle.handle.anchor)) {
    return triangle->triangle;
  }
  return TriangleAt(mesh, handle.rest);
}

// The a of the similarity z → a z + b that maps `rest` to `now` best.
Complex Similarity(const Corners& rest, const Corners& now) {
  const Complex rest_middle = (rest[0] + rest[1] + rest[2]) / 3.0;
  const Complex now_middle = (now[0] + now[1] + now[2]) / 3.0;
  Complex product = 0;
  double norm = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    product += std::conj(rest[i] - rest_middle) * (now[i] - now_middle);
    norm += std::norm(rest[i] - rest_middle);
  }
  return product / norm;
}

}  // namespace

Target PoseOf(const PlanarMesh& mesh, const PlacedHandle& handle,
              std::span<const Complex> positions) {
  const auto triangle = TriangleOf(mesh, handle);
  if (!triangle) return {handle.rest, 0, 1};
  const Corners rest = CornersOf(mesh.vertices, mesh.triangles[*triangle]);
  const Corners now = CornersOf(positions, mesh.triangles[*triangle]);

  Target pose;
  if (const auto* vertex = std::get_if<VertexAnchor>(&handle.handle.anchor)) {
    pose.position = positions[vertex->vertex];
  } else {
    const auto weights = Barycentric(rest, handle.rest);
    pose.position = weights[0] * now[0] + weights[1] * now[1] + weights[2] * now[2];
  }
  const Complex similarity = Similarity(rest, now);
  const double scale = std::abs(similarity);
  if (scale > 0 && scale <= kMaxTargetScale) {
    pose.angle = std::arg(similarity);
    pose.scale = scale;
  }
  return pose;
}

}  // namespace arap::app
