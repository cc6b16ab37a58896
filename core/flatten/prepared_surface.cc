#include "core/flatten/prepared_surface.h"

#include <algorithm>
#include <utility>

#include "core/base/try.h"

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

PreparedSurfaceParts::PreparedSurfaceParts(CutSurface cut, std::size_t vertices,
                                           std::size_t kept_factors)
    : surface(std::move(cut)),
      input_vertices(vertices),
      charts(MakeCharts(surface)),
      factors(std::min(kMaxKeptFactors, kept_factors * charts.size())) {
  surface.topology = {};
  surface.mesh.vertices = {};
}

PreparedSurface::PreparedSurface(std::unique_ptr<const PreparedSurfaceParts> parts)
    : parts_(std::move(parts)) {}

PreparedSurface::~PreparedSurface() = default;

std::size_t PreparedSurface::bytes() const {
  std::size_t bytes =
      BytesOf(parts_->surface.mesh) + BytesOf(parts_->surface.source) + parts_->factors.bytes();
  for (const SurfaceChart& chart : parts_->charts) {
    bytes += sizeof(SurfaceChart) + chart.left_out.capacity() / 8;
    for (const auto& loop : chart.loops) bytes += sizeof(loop) + BytesOf(loop);
    bytes += BytesOf(chart.mesh) + BytesOf(chart.topology) + BytesOf(chart.vertices) +
             BytesOf(chart.triangles) + BytesOf(chart.frames);
  }
  return bytes;
}

Result<std::shared_ptr<const PreparedSurface>> Prepare(SurfaceMesh mesh, const CutOptions& cut,
                                                       const MeshLimits& limits,
                                                       const CancelToken& cancel) {
  const std::size_t vertices = mesh.vertices.size();
  TRY(auto surface, CutToCharts(std::move(mesh), cut, limits, cancel));
  return std::make_shared<const PreparedSurface>(
      std::make_unique<const PreparedSurfaceParts>(std::move(surface), vertices, kKeptFactors));
}

}  // namespace arap
