// What pins cost: a bumpy cap of 100k triangles flattened with other pins than before, from a kept
// surface and anew. Two ways: "nullspace" on the factors that serve any pins, "direct" with the
// pins factored in. Both first steps, and both with 20 refinements at most.
#include <cstdlib>
#include <memory>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "arap/core/flattener.h"
#include "tests/bench/bumpy_cap.h"

namespace arap {
namespace {

template <class T>
T Must(Result<T> result) {
  if (!result) std::abort();
  return std::move(*result);
}

const SurfaceMesh& Cap() {
  static const SurfaceMesh cap = bench::BumpyCap(100'000);
  return cap;
}

// The cap as it lies without pins: where pins go.
const std::vector<Complex>& FreeLayout() {
  static const std::vector<Complex> free = Must(Flatten(Cap(), {})).uv;
  return free;
}

// Every other pin is soft.
FlattenOptions Pinned(std::int64_t count, std::uint64_t seed, int refine) {
  const std::vector<Complex>& free = FreeLayout();
  FlattenOptions options;
  options.refine = refine;
  options.refine_stop = refine > 0 ? 1e-6 : 0;
  std::mt19937_64 random(seed);
  std::vector<bool> taken(free.size());
  while (options.pins.size() < static_cast<std::size_t>(count)) {
    const auto v = static_cast<std::uint32_t>(random() % free.size());
    if (taken[v]) continue;
    taken[v] = true;
    options.pins.push_back({v, 1.02 * free[v], options.pins.size() % 2 == 0 ? 0.0 : 10.0});
  }
  return options;
}

void Fresh(benchmark::State& state, PinSolver solver) {
  std::uint64_t seed = 0;
  FreeLayout();
  for (auto _ : state) {
    benchmark::DoNotOptimize(Must(Flatten(
        Cap(), Pinned(state.range(0), ++seed, static_cast<int>(state.range(1))), {}, {}, solver)));
  }
}

// The surface was flattened without pins once.
void Kept(benchmark::State& state, PinSolver solver) {
  const auto kept = Must(Prepare(Cap(), {}));
  FlattenOptions first;
  first.refine = static_cast<int>(state.range(1));
  Must(Flatten(*kept, first));
  std::uint64_t seed = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(Must(Flatten(
        *kept, Pinned(state.range(0), ++seed, static_cast<int>(state.range(1))), {}, solver)));
  }
}

void Sizes(benchmark::internal::Benchmark* benchmark) {
  for (const std::int64_t refine : {0, 20}) {
    for (const std::int64_t pins : {2, 8, 16, 32, 64}) benchmark->Args({pins, refine});
  }
  benchmark->ArgNames({"pins", "refine"})->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(Fresh, nullspace, PinSolver::kNullSpace)->Apply(Sizes);
BENCHMARK_CAPTURE(Fresh, direct, PinSolver::kDirect)->Apply(Sizes);
BENCHMARK_CAPTURE(Kept, nullspace, PinSolver::kNullSpace)->Apply(Sizes);
BENCHMARK_CAPTURE(Kept, direct, PinSolver::kDirect)->Apply(Sizes);

}  // namespace
}  // namespace arap
