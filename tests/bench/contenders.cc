#include "tests/bench/contenders.h"

#include <algorithm>

#include "arap/core/deformer.h"

namespace arap::bench {

MeshPointer Register(const Scene& scene, Basis basis) {
  return Must(RegisteredMesh::Register(scene.mesh, {basis, Weights::kUniform, {}}));
}

std::vector<std::vector<Target>> TargetsOf(const Scene& scene) {
  std::vector<std::vector<Target>> targets;
  for (const auto& pose : scene.poses) {
    auto& frame = targets.emplace_back();
    for (const Complex p : pose) frame.push_back({p});
  }
  return targets;
}

std::vector<PaperHandle> PaperHandles(const Scene& scene) {
  std::vector<PaperHandle> handles;
  for (const Handle& handle : scene.handles) {
    const Hold hold = HoldOf(scene, handle);
    handles.push_back({hold.vertices, hold.weights});
  }
  return handles;
}

std::vector<std::uint32_t> HandleVertices(const Scene& scene) {
  std::vector<std::uint32_t> vertices;
  for (const Handle& handle : scene.handles) {
    const Hold hold = HoldOf(scene, handle);
    const auto nearest = std::ranges::max_element(hold.weights) - hold.weights.begin();
    vertices.push_back(hold.vertices[static_cast<std::size_t>(nearest)]);
  }
  return vertices;
}

double PaperDisagreement(const Scene& scene) {
  const auto mesh = Register(scene, Basis::kEdgeAsPublished);
  Deformer ours(Must(CompiledHandles::Compile(mesh, scene.handles)));
  PaperScheme paper(scene.mesh);
  paper.Compile(PaperHandles(scene));
  const auto targets = TargetsOf(scene);
  double worst = 0;
  for (std::size_t p = 0; p < targets.size(); ++p) {
    Must(ours.Update(targets[p]));
    const auto theirs = paper.Update(scene.poses[p]);
    for (std::size_t v = 0; v < theirs.size(); ++v) {
      worst = std::max(worst, std::abs(theirs[v] - ours.positions()[v]));
    }
  }
  return worst / mesh->report().diagonal;
}

}  // namespace arap::bench
