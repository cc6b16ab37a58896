#include "server/flattening/flatten_surface.h"

#include <memory>
#include <utility>

#include "server/sessions/content_hash.h"
#include "server/sessions/names.h"

namespace arap::app {

Result<FlatAnswer> FlattenSurface(FlattenCache& cache, const std::string& owner,
                                  const std::string& surface_key, SurfaceMesh mesh,
                                  const FlattenOptions& options, const MeshLimits& limits,
                                  const CancelToken& cancel) {
  if (surface_key.empty()) {
    auto flat = Flatten(std::move(mesh), options, limits, cancel);
    if (!flat) return Fail(std::move(flat.error()));
    return FlatAnswer{*std::move(flat), false};
  }
  if (auto name = CheckName(surface_key, "surface_key"); !name) {
    return Fail(std::move(name.error()));
  }
  // Not after a surface was prepared in vain.
  if (auto ok = CheckFlattenOptions(options, mesh.triangles.size()); !ok) {
    return Fail(std::move(ok.error()));
  }
  auto hash = ContentHash(mesh, options.cut);
  if (!hash) return Fail(std::move(hash.error()));
  std::shared_ptr<const PreparedSurface> surface = cache.Find(owner, surface_key, *hash);
  const bool cached = surface != nullptr;
  if (!cached) {
    auto prepared = Prepare(std::move(mesh), options.cut, limits, cancel);
    if (!prepared) return Fail(std::move(prepared.error()));
    surface = *std::move(prepared);
  }
  auto flat = Flatten(*surface, options, cancel);
  cache.Keep(owner, surface_key, *hash, std::move(surface));
  if (!flat) return Fail(std::move(flat.error()));
  return FlatAnswer{*std::move(flat), cached};
}

}  // namespace arap::app
