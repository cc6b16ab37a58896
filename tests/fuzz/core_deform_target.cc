// Validation, registration, compilation, edits, updates and picks of the core.
#include <array>
#include <string>
#include <vector>

#include "arap/core/compiled_handles.h"
#include "arap/core/deformer.h"
#include "arap/core/pick.h"
#include "arap/core/registered_mesh.h"
#include "tests/fuzz/check.h"
#include "tests/fuzz/shapes.h"
#include "tests/fuzz/targets.h"

namespace arap::fuzz {
namespace {

using Compiled = std::shared_ptr<const CompiledHandles>;

constexpr MeshLimits kLimits{200, 250};

std::string Id(Bytes& bytes) { return std::string(1, static_cast<char>('a' + bytes.Below(8))); }

Handle HandleFrom(Bytes& bytes, const PlanarMesh& mesh) {
  Handle handle;
  handle.id = Id(bytes);
  const auto index = [&](std::size_t count) {
    return bytes.Below(static_cast<std::uint32_t>(std::min<std::size_t>(count + 1, 256)));
  };
  switch (bytes.Below(3)) {
    case 0:
      handle.anchor = VertexAnchor{index(mesh.vertices.size())};
      break;
    case 1: {
      const double u = bytes.Byte() / 255.0, v = (1 - u) * bytes.Byte() / 255.0;
      handle.anchor = TriangleAnchor{index(mesh.triangles.size()), {u, v, 1 - u - v}};
      break;
    }
    default:
      handle.anchor = PointAnchor{{bytes.Number(), bytes.Number()}};
      break;
  }
  const std::uint8_t flags = bytes.Byte();
  handle.hard = (flags & 1u) != 0;
  handle.oriented = (flags & 2u) != 0;
  if ((flags & 4u) != 0) handle.outside = Outside::kSnap;
  if ((flags & 8u) != 0) handle.weight = bytes.Number();
  if ((flags & 16u) != 0) handle.area_radius = bytes.Number();
  if ((flags & 32u) != 0) handle.depth = bytes.Number();
  if ((flags & 64u) != 0) handle.depth_falloff = bytes.Number();
  return handle;
}

std::vector<Handle> HandlesFrom(Bytes& bytes, const PlanarMesh& mesh) {
  std::vector<Handle> handles;
  for (std::uint32_t count = bytes.Below(7); count > 0; --count) {
    handles.push_back(HandleFrom(bytes, mesh));
  }
  return handles;
}

// Some updates and picks; whatever they answer is finite, and a fault leaves the shape as it was.
void Drag(Bytes& bytes, const Compiled& handles) {
  for (const double depth : VertexDepths(*handles)) CheckFinite(depth, "depth");
  Deformer deformer(handles);
  for (std::uint32_t updates = 1 + bytes.Below(3); updates > 0; --updates) {
    std::vector<Target> targets = handles->RestTargets();
    for (Target& target : targets) {
      const std::uint8_t flags = bytes.Byte();
      if ((flags & 3u) != 0) target.position = {bytes.Number(), bytes.Number()};
      if ((flags & 4u) != 0) target.angle = bytes.Number();
      if ((flags & 8u) != 0) target.scale = bytes.Number();
    }
    const DeformOptions options{static_cast<DeformMode>(bytes.Below(3)),
                                static_cast<int>(bytes.Below(4))};
    const auto quality = deformer.Update(targets, options);
    CheckFinite(deformer.positions(), "positions");
    if (!quality) {
      CheckFault(quality.error());
      continue;
    }
    for (const double number : {quality->worst_handle_error, quality->energy, quality->mean_stretch,
                                quality->max_stretch}) {
      CheckFinite(number, "quality");
    }
    Promise(deformer.FlippedTriangles().size() == quality->flipped, "flips are counted");
    const Complex point(bytes.Number(), bytes.Number());
    const auto picks = FindPicks(*handles, deformer.positions(), {&point, 1});
    if (const std::optional<Pick>& pick = picks->front()) {
      CheckFinite(std::array{pick->rest}, "pick");
      for (const double weight : pick->barycentric) CheckFinite(weight, "barycentric");
    }
  }
}

}  // namespace

void CoreDeform(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  PlanarMesh planar = PlanarFrom(bytes);
  const EnergyOptions energy = EnergyFrom(bytes, planar.triangles.size());
  const auto mesh = RegisteredMesh::Register(std::move(planar), energy, kLimits);
  if (!mesh) return CheckFault(mesh.error());
  CheckFinite((*mesh)->report().area, "area");
  CheckFinite((*mesh)->report().diagonal, "diagonal");

  const auto solver = static_cast<HandleSolver>(bytes.Below(3));
  const auto handles =
      CompiledHandles::Compile(*mesh, HandlesFrom(bytes, (*mesh)->mesh()), {}, solver);
  if (!handles) return CheckFault(handles.error());
  Drag(bytes, *handles);

  std::vector<std::string> remove;
  for (std::uint32_t count = bytes.Below(3); count > 0; --count) remove.push_back(Id(bytes));
  const auto edited = (*handles)->Edit(remove, HandlesFrom(bytes, (*mesh)->mesh()));
  if (!edited) return CheckFault(edited.error());
  Drag(bytes, *edited);
}

}  // namespace arap::fuzz
