// The work that is counted, one case per run of the program: `instructions CASE`, or `--list`. Under callgrind only
// the case itself counts, not what prepares it; check.sh runs it so.
#include <cstdio>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <valgrind/callgrind.h>

#include "arap/core/compiled_handles.h"
#include "arap/core/deformer.h"
#include "arap/core/flattener.h"
#include "arap/core/registered_mesh.h"
#include "tests/support/meshes.h"
#include "tests/support/surfaces.h"

namespace arap::bench {
namespace {

constexpr std::size_t kSquares = 50;  // along a side: 2,601 vertices

template <class T>
T Must(Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "instructions: %s\n", result.error().message.c_str());
  std::exit(1);
}

// Counts what `work` takes. What it returns is destroyed afterwards.
template <class Work>
auto Count(Work work) {
  CALLGRIND_TOGGLE_COLLECT;
  auto result = work();
  CALLGRIND_TOGGLE_COLLECT;
  return result;
}

std::shared_ptr<const RegisteredMesh> Register(Basis basis) {
  return Must(
      RegisteredMesh::Register(testing::JitteredGrid(kSquares, kSquares, 1), {basis, {}, {}}));
}

// Eight vertices, far from one another.
std::vector<Handle> Handles() {
  constexpr std::uint32_t kCount = 8, kRow = kSquares + 1;
  std::vector<Handle> handles(kCount);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    handles[i].id = "h" + std::to_string(i);
    handles[i].anchor = VertexAnchor{(i * (kRow - 1) / (kCount - 1)) * kRow + (i * 19) % kRow};
  }
  return handles;
}

std::shared_ptr<const CompiledHandles> Compile(Basis basis) {
  return Must(CompiledHandles::Compile(Register(basis), Handles()));
}

void Update(Basis basis, const DeformOptions& options = {}) {
  const auto handles = Compile(basis);
  Deformer deformer(handles);
  std::vector<Target> targets = handles->RestTargets();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    targets[i].position += Complex(i % 2 == 0 ? 5 : -3, static_cast<double>(i));
  }
  Must(deformer.Update(targets, options));  // the first allocates
  Must(Count([&] { return deformer.Update(targets, options); }));
}

// `angle`: how deep the cap is, from its pole to its rim.
void Flattened(FlattenMethod method, int refine, double angle = 1.8, bool injective = false) {
  FlattenOptions options;
  options.method = method;
  options.injective = injective;
  options.energy = {Basis::kFace, Weights::kCotangent, {}};
  options.refine = refine;
  SurfaceMesh cap = testing::SphereCap(30, 60, angle);
  Must(Count([&] { return Flatten(std::move(cap), options); }));
}

struct Case {
  const char* name;
  void (*run)();
};

constexpr Case kCases[] = {
    {"register_edge", [] { Count([] { return Register(Basis::kEdge); }); }},
    {"register_face", [] { Count([] { return Register(Basis::kFace); }); }},
    {"compile_8",
     [] {
       const auto mesh = Register(Basis::kEdge);
       Must(Count([&] { return CompiledHandles::Compile(mesh, Handles()); }));
     }},
    {"edit_1_for_1",
     [] {
       const auto set = Compile(Basis::kEdge);
       Handle added;
       added.id = "added";
       added.anchor = VertexAnchor{1'300};
       const std::string removed[] = {"h3"};
       Must(Count([&] { return set->Edit(removed, {added}); }));
     }},
    {"update_edge", [] { Update(Basis::kEdge); }},
    {"update_face", [] { Update(Basis::kFace); }},
    {"update_unmeasured", [] { Update(Basis::kEdge, {.measure_every = 0}); }},
    {"flatten_lscm", [] { Flattened(FlattenMethod::kFirstStep, 0); }},
    {"flatten_arap_20", [] { Flattened(FlattenMethod::kArap, 20); }},
    {"flatten_injective", [] { Flattened(FlattenMethod::kArap, 20, 2.8, true); }},
};

int Run(const char* name) {
  for (const Case& one : kCases) {
    if (std::strcmp(name, "--list") == 0) {
      std::puts(one.name);
    } else if (std::strcmp(name, one.name) == 0) {
      one.run();
      return 0;
    }
  }
  return std::strcmp(name, "--list") == 0 ? 0 : 2;
}

}  // namespace
}  // namespace arap::bench

int main(int argc, char** argv) { return argc == 2 ? arap::bench::Run(argv[1]) : 2; }
