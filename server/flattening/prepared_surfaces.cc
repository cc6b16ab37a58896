#include "server/flattening/prepared_surfaces.h"

#include <bit>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/runtime/clock.h"

namespace arap::app {
namespace {

// To be changed whenever the same surface would get other factors.
constexpr std::string_view kSurfaceTag = "arap surface 1\n";

void Number(Sha256& hash, std::uint64_t number) { hash.Bytes(&number, sizeof number); }

template <class T>
void Array(Sha256& hash, const std::vector<T>& items) {
  Number(hash, items.size());
  hash.Bytes(items.data(), items.size() * sizeof(T));
}

// What is under a key: the content has to fit too.
struct Kept {
  std::string content_hash;
  std::shared_ptr<const PreparedSurface> surface;
};

DerivedKey KeyOf(const std::string& owner, const std::string& key) {
  return {owner, DerivedKind::kSurface, key};
}

void Measure(const FlattenTimes& times, double micros, runtime::Metrics& metrics) {
  using runtime::Phase;
  metrics.Phase(Phase::kFlatten, micros * 1e-6);
  metrics.Phase(Phase::kFlattenTopology, times.topology * 1e-3);
  metrics.Phase(Phase::kFlattenOrder, times.order * 1e-3);
  metrics.Phase(Phase::kFlattenFactor, times.factor * 1e-3);
  metrics.Phase(Phase::kFlattenSolve, times.solve * 1e-3);
}

}  // namespace

Result<FlatAnswer> PreparedSurfaces::Flatten(const Caller& caller, const std::string& surface_key,
                                             SurfaceMesh mesh, const FlattenOptions& options,
                                             const CancelToken& cancel,
                                             const FlattenProgress& progress) {
  const runtime::WallTimer working;
  const FlattenCost cost =
      EstimateFlatten(SizeOf(mesh, options.cut), options, !surface_key.empty());
  TRY(const auto room, derived_.Reserve(caller, cost.bytes));
  FlatAnswer answer;
  if (surface_key.empty()) {
    TRY(answer.flat,
        arap::Flatten(std::move(mesh), options, limits_, cancel, PinSolver::kAuto, progress));
  } else {
    TRY(answer,
        FlattenNamed(caller.owner, surface_key, std::move(mesh), options, cancel, progress));
  }
  Measure(answer.flat.times, working.Micros(), metrics_);
  return answer;
}

Result<FlatAnswer> PreparedSurfaces::FlattenNamed(const std::string& owner, const std::string& key,
                                                  SurfaceMesh mesh, const FlattenOptions& options,
                                                  const CancelToken& cancel,
                                                  const FlattenProgress& progress) {
  CHECK_OK(CheckName(key, "surface_key"));
  // Before a surface is prepared in vain.
  CHECK_OK(CheckFlattenOptions(options, mesh.triangles.size()));
  TRY(const std::string hash, ContentHash(mesh, options.cut));
  std::shared_ptr<const PreparedSurface> surface = Find(owner, key, hash);
  const bool cached = surface != nullptr;
  if (!cached) {
    TRY(surface, Prepare(std::move(mesh), options.cut, limits_, cancel));
  }
  auto flat = arap::Flatten(*surface, options, cancel, PinSolver::kAuto, progress);
  Keep(owner, key, hash, std::move(surface));
  if (!flat) return Fail(std::move(flat.error()));
  return FlatAnswer{*std::move(flat), cached};
}

std::shared_ptr<const PreparedSurface> PreparedSurfaces::Find(const std::string& owner,
                                                              const std::string& key,
                                                              const std::string& content_hash) {
  const auto kept = derived_.Find<Kept>(KeyOf(owner, key));
  return kept && kept->content_hash == content_hash ? kept->surface : nullptr;
}

void PreparedSurfaces::Keep(const std::string& owner, const std::string& key,
                            const std::string& content_hash,
                            std::shared_ptr<const PreparedSurface> surface) {
  const std::size_t bytes = surface->bytes();
  auto kept = std::make_shared<const Kept>(Kept{content_hash, std::move(surface)});
  derived_.Keep<Kept>(KeyOf(owner, key), std::move(kept), bytes, true);
}

Result<std::string> ContentHash(const SurfaceMesh& mesh, const CutOptions& options) {
  // What is hashed byte by byte has no bytes between its numbers.
  static_assert(sizeof(Point3) == 3 * sizeof(double));
  Sha256 hash;
  hash.Bytes(kSurfaceTag.data(), kSurfaceTag.size());
  const RepairOptions& repair = options.repair;
  if (repair != RepairOptions{}) {
    for (const bool asked :
         {repair.weld, repair.drop_duplicates, repair.stitch, repair.tolerance.has_value()}) {
      Number(hash, asked ? 3 : 2);
    }
    Number(hash, std::bit_cast<std::uint64_t>(repair.tolerance.value_or(0)));
  }
  Number(hash, options.auto_cut ? 1 : 0);
  Number(hash, options.split_non_manifold ? 1 : 0);
  Number(hash, options.tolerate_degenerate ? 1 : 0);
  Array(hash, options.seams);
  Array(hash, mesh.vertices);
  Array(hash, mesh.triangles);
  return hash.Hex();
}

}  // namespace arap::app
