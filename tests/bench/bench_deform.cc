// What a registration, a compilation, an edit and an update cost. Sizes are vertices; handles are
// points inside triangles. "nullspace" and "direct" compile the same handles in the two ways.
#include <cmath>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "arap/core/compiled_handles.h"
#include "arap/core/deformer.h"
#include "arap/core/registered_mesh.h"
#include "tests/support/meshes.h"

namespace arap {
namespace {

template <class T>
T Must(Result<T> result) {
  if (!result) std::abort();
  return std::move(*result);
}

PlanarMesh MeshOf(std::int64_t vertices) {
  const auto side =
      static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(vertices)))) - 1;
  return testing::JitteredGrid(side, side, 1);
}

std::shared_ptr<const RegisteredMesh> Registered(std::int64_t vertices,
                                                 Basis basis = Basis::kEdge) {
  return Must(RegisteredMesh::Register(MeshOf(vertices), {basis, Weights::kUniform, {}}));
}

std::vector<Handle> Handles(const RegisteredMesh& mesh, std::int64_t count,
                            const char* prefix = "h") {
  std::mt19937_64 random(3);
  std::vector<Handle> handles;
  for (std::int64_t i = 0; i < count; ++i) {
    Handle handle;
    handle.id = std::string(prefix).append(std::to_string(i));
    handle.anchor = TriangleAnchor{
        static_cast<std::uint32_t>(random() % mesh.mesh().triangles.size()), {0.5, 0.3, 0.2}};
    handles.push_back(handle);
  }
  return handles;
}

std::vector<Target> Targets(const CompiledHandles& set) {
  auto targets = set.RestTargets();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    targets[i].position +=
        Complex(std::sin(static_cast<double>(i)), std::cos(static_cast<double>(i)));
  }
  return targets;
}

void BM_Register(benchmark::State& state) {
  const PlanarMesh mesh = MeshOf(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(Must(RegisteredMesh::Register(mesh, {})));
}
BENCHMARK(BM_Register)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

// Compile and update the same handles in both forms: where they cross is kDirectRows.
HandleSolver SolverOf(std::int64_t number) {
  return number == 0 ? HandleSolver::kNullSpace : HandleSolver::kDirect;
}

void BM_Compile(benchmark::State& state) {
  const auto mesh = Registered(state.range(0));
  const auto handles = Handles(*mesh, state.range(1));
  const HandleSolver solver = SolverOf(state.range(2));
  for (auto _ : state) {
    benchmark::DoNotOptimize(Must(CompiledHandles::Compile(mesh, handles, {}, solver)));
  }
}
BENCHMARK(BM_Compile)
    ->ArgNames({"vertices", "handles", "direct"})
    ->ArgsProduct({{1000, 10000}, {8, 32, 64, 96, 128}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

void BM_UpdateBy(benchmark::State& state) {
  const auto mesh = Registered(state.range(0));
  const auto set = Must(
      CompiledHandles::Compile(mesh, Handles(*mesh, state.range(1)), {}, SolverOf(state.range(2))));
  const auto targets = Targets(*set);
  Deformer deformer(set);
  for (auto _ : state) benchmark::DoNotOptimize(Must(deformer.Update(targets)));
}
BENCHMARK(BM_UpdateBy)
    ->ArgNames({"vertices", "handles", "direct"})
    ->ArgsProduct({{1000, 10000}, {8, 32, 64, 96, 128}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

void BM_AddOneHandle(benchmark::State& state) {
  const auto mesh = Registered(state.range(0));
  const auto set = Must(CompiledHandles::Compile(mesh, Handles(*mesh, 8)));
  for (auto _ : state) benchmark::DoNotOptimize(Must(set->Edit({}, Handles(*mesh, 1, "new"))));
}
BENCHMARK(BM_AddOneHandle)->Arg(1000)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

// What an update costs that names every handle, in an order that is not the set's.
void BM_FindAllHandles(benchmark::State& state) {
  const auto mesh = Registered(1000);
  const auto set = Must(CompiledHandles::Compile(mesh, Handles(*mesh, state.range(0))));
  const auto& handles = set->handles();
  for (auto _ : state) {
    for (std::size_t i = handles.size(); i-- > 0;) {
      benchmark::DoNotOptimize(set->Find(handles[i].handle.id));
    }
  }
  state.SetComplexityN(state.range(0));
}
BENCHMARK(BM_FindAllHandles)->Arg(100)->Arg(1000)->Complexity(benchmark::oNLogN);

void BM_RemoveOneHandle(benchmark::State& state) {
  const auto mesh = Registered(state.range(0));
  const auto set = Must(CompiledHandles::Compile(mesh, Handles(*mesh, 8)));
  const std::vector<std::string> remove{"h3"};
  for (auto _ : state) benchmark::DoNotOptimize(Must(set->Edit(remove, {})));
}
BENCHMARK(BM_RemoveOneHandle)->Arg(10000)->Unit(benchmark::kMillisecond);

void BM_Update(benchmark::State& state) {
  const auto mesh = Registered(state.range(0), static_cast<Basis>(state.range(2)));
  const auto set = Must(CompiledHandles::Compile(mesh, Handles(*mesh, state.range(1))));
  const auto targets = Targets(*set);
  Deformer deformer(set);
  for (auto _ : state) benchmark::DoNotOptimize(Must(deformer.Update(targets)));
}
BENCHMARK(BM_Update)
    ->ArgNames({"vertices", "handles", "basis"})
    ->ArgsProduct({{1000, 10000}, {8}, {0, 2, 3}})
    ->Args({100000, 8, 0})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace arap
