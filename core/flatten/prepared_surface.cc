#include "core/flatten/prepared_surface.h"

#include <algorithm>

namespace arap {
namespace {

template <class T>
std::size_t BytesOf(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

std::size_t BytesOf(const Topology& topology) {
  return BytesOf(topology.edges) + BytesOf(topology.triangle_edges) +
         BytesOf(topology.vertex_component) + BytesOf(topology.triangle_piece);
}

std::size_t BytesOf(const SurfaceMesh& mesh) {
  return BytesOf(mesh.vertices) + BytesOf(mesh.triangles);
}

}  // namespace

PreparedSurface::PreparedSurface(CutSurface surface, std::size_t input_vertices,
                                 std::size_t kept_factors)
    : surface_(std::move(surface)),
      input_vertices_(input_vertices),
      charts_(MakeCharts(surface_)),
      factors_(std::min(kMaxKeptFactors, kept_factors * charts_.size())) {
  // The charts have what is needed of these.
  surface_.topology = {};
  surface_.mesh.vertices = {};
}

std::size_t PreparedSurface::bytes() const {
  std::size_t bytes = BytesOf(surface_.mesh) + BytesOf(surface_.source) + factors_.bytes();
  for (const SurfaceChart& chart : charts_) {
    bytes += sizeof(SurfaceChart) + chart.left_out.capacity() / 8;
    for (const auto& loop : chart.loops) bytes += sizeof(loop) + BytesOf(loop);
    bytes += BytesOf(chart.mesh) + BytesOf(chart.topology) + BytesOf(chart.vertices) +
             BytesOf(chart.triangles) + BytesOf(chart.frames);
  }
  return bytes;
}

Result<std::shared_ptr<const PreparedSurface>> Prepare(SurfaceMesh mesh, const CutOptions& options,
                                                       const CancelToken& cancel) {
  const std::size_t vertices = mesh.vertices.size();
  auto surface = CutToCharts(std::move(mesh), options, cancel);
  if (!surface) return Fail(std::move(surface.error()));
  return std::make_shared<const PreparedSurface>(*std::move(surface), vertices, kKeptFactors);
}

}  // namespace arap
