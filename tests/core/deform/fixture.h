// Short cuts for tests of deformation: register, compile and deform, or end the program.
#pragma once

#include <memory>
#include <random>
#include <string>
#include <vector>

#include "arap/core/compiled_handles.h"
#include "arap/core/deformer.h"
#include "arap/core/registered_mesh.h"
#include "tests/support/must.h"

namespace arap::testing {

inline std::shared_ptr<const RegisteredMesh> Register(const PlanarMesh& mesh,
                                                      Basis basis = Basis::kEdge,
                                                      Weights weights = Weights::kUniform,
                                                      std::vector<double> rigidity = {}) {
  return Must(RegisteredMesh::Register(mesh, {basis, weights, std::move(rigidity)}));
}

inline std::shared_ptr<const CompiledHandles> Compile(std::shared_ptr<const RegisteredMesh> mesh,
                                                      std::vector<Handle> handles) {
  return Must(CompiledHandles::Compile(std::move(mesh), std::move(handles)));
}

inline Handle OnVertex(std::string id, std::uint32_t vertex) {
  Handle handle;
  handle.id = std::move(id);
  handle.anchor = VertexAnchor{vertex};
  return handle;
}

inline Handle InTriangle(std::string id, std::uint32_t triangle,
                         std::array<double, 3> barycentric) {
  Handle handle;
  handle.id = std::move(id);
  handle.anchor = TriangleAnchor{triangle, barycentric};
  return handle;
}

// `count` handles in different triangles, at random points of them.
inline std::vector<Handle> RandomHandles(const PlanarMesh& mesh, std::size_t count,
                                         std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Handle> handles;
  std::vector<bool> taken(mesh.triangles.size(), false);
  while (handles.size() < count) {
    const auto t = static_cast<std::uint32_t>(random() % mesh.triangles.size());
    if (taken[t]) continue;
    taken[t] = true;
    const double a = 0.1 + 0.1 * static_cast<double>(random() % 4);
    const double b = 0.1 + 0.1 * static_cast<double>(random() % 4);
    handles.push_back(InTriangle("h" + std::to_string(handles.size()), t, {a, b, 1 - a - b}));
  }
  return handles;
}

// Rest targets moved at random by up to `amount` in x and y.
inline std::vector<Target> RandomTargets(const CompiledHandles& set, double amount,
                                         std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto next = [&] { return 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1; };
  std::vector<Target> targets = set.RestTargets();
  for (Target& t : targets) {
    const double dx = next(), dy = next();
    t.position += amount * Complex(dx, dy);
  }
  return targets;
}

// One shape.
inline std::vector<Complex> Deform(const std::shared_ptr<const CompiledHandles>& set,
                                   const std::vector<Target>& targets, DeformOptions options = {},
                                   ShapeQuality* quality = nullptr) {
  Deformer deformer(set);
  const ShapeQuality q = Must(deformer.Update(targets, options));
  if (quality) *quality = q;
  return {deformer.positions().begin(), deformer.positions().end()};
}

}  // namespace arap::testing
