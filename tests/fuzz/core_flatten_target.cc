// Cutting and flattening of the core, with every option.
#include "arap/core/flattener.h"
#include "tests/fuzz/check.h"
#include "tests/fuzz/shapes.h"
#include "tests/fuzz/targets.h"

namespace arap::fuzz {
namespace {

std::uint32_t VertexFrom(Bytes& bytes, const SurfaceMesh& mesh) {
  return bytes.Below(
      static_cast<std::uint32_t>(std::min<std::size_t>(mesh.vertices.size() + 1, 256)));
}

FlattenOptions OptionsFrom(Bytes& bytes, const SurfaceMesh& mesh) {
  FlattenOptions options;
  options.method = static_cast<FlattenMethod>(bytes.Below(3));
  options.anchors = static_cast<FlattenAnchors>(bytes.Below(3));
  options.energy = EnergyFrom(bytes, mesh.triangles.size());
  const std::uint8_t flags = bytes.Byte();
  options.injective = (flags & 1u) != 0;
  options.cut.auto_cut = (flags & 2u) != 0;
  options.cut.split_non_manifold = (flags & 4u) != 0;
  options.cut.tolerate_degenerate = (flags & 8u) != 0;
  if ((flags & 16u) != 0) options.refine = static_cast<int>(bytes.Below(12));
  if ((flags & 32u) != 0) options.refine_stop = bytes.Number();
  const std::uint8_t counts = bytes.Byte();
  for (std::uint32_t i = 0; i < (counts & 3u); ++i) {
    options.cut.seams.push_back({VertexFrom(bytes, mesh), VertexFrom(bytes, mesh)});
  }
  for (std::uint32_t i = 0; i < (counts >> 2u & 3u); ++i) {
    options.pins.push_back({VertexFrom(bytes, mesh),
                            {bytes.Number(), bytes.Number()},
                            bytes.Coin() ? 0 : bytes.Number()});
  }
  for (std::uint32_t i = 0; i < (counts >> 4u & 1u); ++i) {
    options.grain_lines.push_back(
        {VertexFrom(bytes, mesh), VertexFrom(bytes, mesh), bytes.Number()});
  }
  return options;
}

void CheckDistortion(const Distortion& distortion) {
  for (const double number :
       {distortion.arap_energy, distortion.symmetric_dirichlet, distortion.area_ratio,
        distortion.mean_stretch_percent, distortion.max_stretch_percent,
        distortion.mean_compression_percent, distortion.max_compression_percent,
        distortion.mean_angle_degrees, distortion.max_angle_degrees}) {
    CheckFinite(number, "distortion");
  }
}

}  // namespace

void CoreFlatten(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  SurfaceMesh mesh = SurfaceFrom(bytes);
  const FlattenOptions options = OptionsFrom(bytes, mesh);
  const std::size_t triangles = mesh.triangles.size();
  const auto flat = Flatten(std::move(mesh), options, {200, 250});
  if (!flat) return CheckFault(flat.error());
  CheckFinite(flat->uv, "uv");
  CheckFinite(flat->first_step, "first_step");
  CheckDistortion(flat->distortion);
  for (const FlatChart& chart : flat->charts) CheckDistortion(chart.distortion);
  for (const auto& values : flat->singular_values) {
    for (const double value : values) CheckFinite(value, "singular value");
  }
  Promise(flat->corner_uv.size() == triangles, "every triangle has its corners");
  for (const auto& corners : flat->corner_uv) {
    for (const std::uint32_t corner : corners) {
      Promise(corner < flat->uv.size(), "every corner has a place");
    }
  }
  if (options.injective) Promise(flat->distortion.flipped == 0, "injective has no flips");
}

}  // namespace arap::fuzz
