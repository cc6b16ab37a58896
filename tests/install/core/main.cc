// Moves a square by its handles and lays a bent strip flat, without a server.
#include <cmath>
#include <cstdio>
#include <vector>

#include <arap/core/compiled_handles.h>
#include <arap/core/cost.h>
#include <arap/core/deformer.h>
#include <arap/core/flattener.h>
#include <arap/core/pick.h>
#include <arap/core/registered_mesh.h>

namespace {

bool Near(arap::Complex a, arap::Complex b) { return std::abs(a - b) < 1e-9; }

int Tell(const arap::Fault& fault) {
  std::puts(fault.message.c_str());
  return 1;
}

}  // namespace

int main() {
  const arap::PlanarMesh square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto mesh = arap::RegisteredMesh::Register(square, {});
  if (!mesh) return Tell(mesh.error());
  const std::vector<arap::Handle> handles{{"a", arap::VertexAnchor{0}},
                                          {"b", arap::VertexAnchor{2}}};
  const auto set = arap::CompiledHandles::Compile(*mesh, handles);
  if (!set) return Tell(set.error());
  arap::Deformer deformer(*set);
  const auto quality = deformer.Update(std::vector<arap::Target>{{{5, 5}}, {{6, 6}}});
  if (!quality) return Tell(quality.error());
  if (quality->flipped != 0 || !Near(deformer.positions()[1], {6, 5})) return 2;
  const auto picks =
      arap::FindPicks(**set, deformer.positions(), std::vector<arap::Complex>{{5.5, 5.25}});
  if (!picks || !picks->at(0) || !Near(picks->at(0)->rest, {0.5, 0.25})) return 3;
  if (arap::DeformerBytes(**set) == 0) return 4;

  const arap::SurfaceMesh bent{{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 1, 0}, {1, 1, 0}, {1, 1, 1}},
                               {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}}};
  const auto flat = arap::Flatten(bent, arap::ArapOptions());
  if (!flat) return Tell(flat.error());
  if (std::abs(std::abs(flat->uv[0] - flat->uv[2]) - 2) > 1e-9) return 5;
  std::puts("ok");
  return 0;
}
