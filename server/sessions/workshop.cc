#include "server/sessions/workshop.h"

#include <utility>

#include "server/sessions/handle_sets.h"
#include "server/sessions/meshes.h"

namespace arap::app {

Workshop::Workshop(const Limits& the_limits, const runtime::Clock& the_clock,
                   store::Stores the_stores)
    : limits(the_limits),
      clock(the_clock),
      stores(store::Measured(std::move(the_stores), metrics)),
      keeper(*stores.specs, *stores.blobs, clock, stores.allow_lossy),
      derived(limits.max_bytes, {limits.max_cached_surfaces, limits.max_cached_surface_bytes},
              clock),
      sessions(limits, clock, *stores.specs, derived,
               [this](const store::SessionRecord& record) { Release(record); }) {
  derived.Listen(
      {[this](DerivedKind kind, bool hit) {
         hit ? metrics.CacheHit(NameOf(kind)) : metrics.CacheMiss(NameOf(kind));
       },
       [this](DerivedKind kind, std::size_t bytes) { metrics.Evicted(NameOf(kind), bytes); }});
}

void Workshop::ReleaseHandleSet(const store::SessionKey& session,
                                const std::string& handle_set_id) {
  derived.Forget(HandleSetKey(session, handle_set_id));
}

void Workshop::ReleaseMesh(const std::string& owner, const std::string& blob) {
  if (!sessions.InUse(owner, blob)) derived.Forget(MeshKey(owner, blob));
}

void Workshop::Release(const store::SessionRecord& record) {
  for (const auto& [id, set] : record.handle_sets) ReleaseHandleSet(record.key, id);
  for (const auto& [id, mesh] : record.meshes) ReleaseMesh(record.key.owner, mesh.blob);
}

}  // namespace arap::app
