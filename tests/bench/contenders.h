// Setting up the contenders on a scene.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "arap/base/result.h"
#include "arap/core/compiled_handles.h"
#include "arap/core/registered_mesh.h"
#include "tests/bench/paper_scheme.h"
#include "tests/bench/scene.h"

namespace arap::bench {

[[noreturn]] inline void Die(std::string_view message) {
  std::fprintf(stderr, "bench_compare: %.*s\n", static_cast<int>(message.size()), message.data());
  std::exit(1);
}

template <class T>
T Must(Result<T> result) {
  if (!result) Die(result.error().message);
  return std::move(*result);
}

using MeshPointer = std::shared_ptr<const RegisteredMesh>;
using HandlesPointer = std::shared_ptr<const CompiledHandles>;

MeshPointer Register(const Scene& scene, Basis basis);
// Per pose one target per handle.
std::vector<std::vector<Target>> TargetsOf(const Scene& scene);

std::vector<PaperHandle> PaperHandles(const Scene& scene);
// The vertex nearest to each handle, for those who hold vertices only.
std::vector<std::uint32_t> HandleVertices(const Scene& scene);

// The largest distance between two positions of a vertex when the poses of the scene are taken with
// the paper's scheme and with ours (EDGE as published, uniform weights), in diagonals of the mesh.
double PaperDisagreement(const Scene& scene);

}  // namespace arap::bench
