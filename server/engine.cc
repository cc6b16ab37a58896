#include "server/engine.h"

#include <set>
#include <utility>

#include "server/sessions/warm.h"
#include "server/store/measured.h"

namespace arap::app {
namespace {

using std::chrono::seconds;

// A registration puts its blob before the record that names it: within this time, or the blob is
// taken for left behind.
constexpr seconds kBlobAge{600};
constexpr seconds kCollectEvery{60};

}  // namespace

Engine::Engine(const Limits& the_limits, const Lanes& the_lanes, const runtime::Clock& the_clock,
               store::Stores the_stores)
    : limits(the_limits),
      lanes(the_lanes),
      clock(the_clock),
      stores(store::Measured(std::move(the_stores), metrics)),
      derived(limits.max_bytes, {limits.max_cached_surfaces, limits.max_cached_surface_bytes},
              clock),
      sessions(limits, clock, *stores.specs,
               [this](const store::SessionRecord& record) { Release(record); }),
      surfaces(derived),
      streams(limits.max_streams),
      load(limits.max_stream_load, static_cast<double>(lanes.workers)),
      registrations("max_registrations", limits.max_registrations),
      compilations("max_compilations", limits.max_compilations),
      flattenings("max_flattenings", limits.max_flattenings),
      interactive({"interactive", lanes.workers, limits.max_queued_jobs, &metrics}),
      control({"control", lanes.control_workers, limits.max_queued_jobs, &metrics}),
      jobs({"jobs", lanes.job_workers, limits.max_queued_jobs, &metrics, &interactive}),
      collected_(clock.SteadyNow()) {
  derived.Listen(
      {[this](DerivedKind kind, bool hit) {
         hit ? metrics.CacheHit(NameOf(kind)) : metrics.CacheMiss(NameOf(kind));
       },
       [this](DerivedKind kind, std::size_t bytes) { metrics.Evicted(NameOf(kind), bytes); }});
}

Status Engine::Sweep() {
  streams.Sweep(clock.SteadyNow());
  load.Look(interactive.stats().busy, clock.SteadyNow());
  derived.EvictIdle(limits.idle_evict);
  if (auto swept = sessions.Sweep(); !swept) return swept;
  const auto now = clock.SteadyNow();
  if (now - collected_ < kCollectEvery) return {};
  collected_ = now;
  auto report = CollectBlobs(kBlobAge);
  if (!report) return Fail(std::move(report.error()));
  return {};
}

Result<store::SweepReport> Engine::CollectBlobs(seconds age) {
  auto referenced = stores.specs->ReferencedBlobs();
  if (!referenced) return Fail(std::move(referenced.error()));
  return stores.blobs->Sweep(*referenced, age);
}

void Engine::ReleaseHandleSet(const store::SessionKey& session, const std::string& handle_set_id) {
  derived.Forget(HandleSetKey(session, handle_set_id));
}

void Engine::ReleaseMesh(const std::string& owner, const std::string& blob) {
  if (!sessions.InUse(owner, blob)) derived.Forget(MeshKey(owner, blob));
}

void Engine::Release(const store::SessionRecord& record) {
  for (const auto& [id, set] : record.handle_sets) ReleaseHandleSet(record.key, id);
  for (const auto& [id, mesh] : record.meshes) ReleaseMesh(record.key.owner, mesh.blob);
}

}  // namespace arap::app
