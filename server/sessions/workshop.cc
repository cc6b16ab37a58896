#include "server/sessions/workshop.h"

#include <limits>
#include <memory>
#include <utility>

#include "core/base/names.h"
#include "core/base/try.h"
#include "server/runtime/clock.h"
#include "server/runtime/metrics.h"
#include "server/store/blobs/mesh_blob.h"

namespace arap::app {
namespace {

// A compiled set, and what tells whether it is the one that a record means: another process may
// have changed the set under its id.
struct CompiledSet {
  std::string blob;
  store::HandleDefinitions definitions;
  std::shared_ptr<const CompiledHandles> handles;
};

bool IsOf(const CompiledSet& set, const store::HandleSetRecord& record, const std::string& blob) {
  return set.blob == blob && store::SameDefinitions(set.definitions, record.definitions);
}

// The handles; who holds them holds the set that is kept, which therefore counts as in use.
std::shared_ptr<const CompiledHandles> HandlesOf(const std::shared_ptr<const CompiledSet>& set) {
  return {set, set->handles.get()};
}

// Blobs are named by their digest; the client knows its mesh by the id.
Fault NamingMesh(Fault fault, const std::string& mesh_id) {
  if (fault.kind == FaultKind::kDataLoss) {
    fault.message = "The stored mesh " + Quote(mesh_id) + " cannot be read: " + fault.message;
    fault.Detail("mesh", mesh_id);
  }
  return fault;
}

Result<std::shared_ptr<const RegisteredMesh>> Rebuild(Workshop& workshop, const Caller& caller,
                                                      const std::string& blob,
                                                      const CancelToken& cancel) {
  TRY(auto bytes, workshop.stores.blobs->Get(blob));
  TRY(auto stored, store::DecodeMesh(bytes));
  bytes = {};
  TRY(const auto room,
      workshop.derived.Reserve(
          caller, EstimateRegistration(stored.mesh.vertices.size(), stored.options.basis).bytes));
  // What was accepted once stays, also when the limits have shrunk since.
  constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
  const runtime::WallTimer working;
  TRY(auto mesh,
      RegisteredMesh::Register(std::move(stored.mesh), stored.options, {kAny, kAny}, cancel));
  workshop.metrics.Phase(runtime::Phase::kRebuild, working.Micros() * 1e-6);
  return mesh;
}

}  // namespace

DerivedKey MeshKey(const std::string& owner, const std::string& blob) {
  return {owner, DerivedKind::kMesh, blob};
}

DerivedKey HandleSetKey(const store::SessionKey& session, const std::string& handle_set_id) {
  // No id has a slash.
  return {session.owner, DerivedKind::kHandleSet, session.id + "/" + handle_set_id};
}

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

PeekedMesh PeekMesh(Workshop& workshop, const Session& session, const std::string& mesh_id) {
  const auto record = session.record();
  const auto mesh = record->meshes.find(mesh_id);
  if (mesh == record->meshes.end()) return {};
  auto kept = workshop.derived.Peek<RegisteredMesh>(MeshKey(record->key.owner, mesh->second.blob));
  return {kept ? Warmth::kWarm : Warmth::kCold, std::move(kept)};
}

PeekedSet PeekHandleSet(Workshop& workshop, const Session& session,
                        const std::string& handle_set_id) {
  const auto record = session.record();
  const auto set = record->handle_sets.find(handle_set_id);
  if (set == record->handle_sets.end()) return {};
  const auto kept = workshop.derived.Peek<CompiledSet>(HandleSetKey(record->key, handle_set_id));
  if (!kept || !IsOf(*kept, set->second, record->meshes.at(set->second.mesh_id).blob)) {
    return {Warmth::kCold, nullptr};
  }
  return {Warmth::kWarm, HandlesOf(kept)};
}

Result<MeshEntry> WarmMesh(Workshop& workshop, const Caller& caller, const Session& session,
                           const std::string& mesh_id, const CancelToken& cancel) {
  TRY(const auto mesh, FindMesh(*session.record(), mesh_id));
  const DerivedKey key = MeshKey(session.key().owner, mesh.blob);
  if (auto kept = workshop.derived.Find<RegisteredMesh>(key)) {
    return MeshEntry{mesh_id, mesh.blob, std::move(kept)};
  }
  auto rebuilt = Rebuild(workshop, caller, mesh.blob, cancel);
  if (!rebuilt) return Fail(NamingMesh(std::move(rebuilt.error()), mesh_id));
  return KeepWarm(workshop, session.key().owner, {mesh_id, mesh.blob, *std::move(rebuilt)});
}

Result<HandleSetEntry> WarmHandleSet(Workshop& workshop, const Caller& caller,
                                     const Session& session, const std::string& handle_set_id,
                                     const CancelToken& cancel) {
  const auto record = session.record();
  TRY(auto set, FindHandleSet(*record, handle_set_id));
  const std::string& blob = record->meshes.at(set.mesh_id).blob;
  HandleSetEntry entry{handle_set_id, set.mesh_id, set.definitions, nullptr, set.revision, blob};
  const auto kept = workshop.derived.Find<CompiledSet>(HandleSetKey(session.key(), handle_set_id));
  if (kept && IsOf(*kept, set, blob)) {
    entry.handles = HandlesOf(kept);
    return entry;
  }
  TRY(const auto mesh, WarmMesh(workshop, caller, session, set.mesh_id, cancel));
  TRY(const Cost cost, CompilationCostOf(*mesh.mesh, *set.definitions, cancel));
  TRY(const auto room, workshop.derived.Reserve(caller, cost.bytes));
  const runtime::WallTimer working;
  TRY(entry.handles, CompiledHandles::Compile(mesh.mesh, *set.definitions, cancel));
  workshop.metrics.Phase(runtime::Phase::kRebuild, working.Micros() * 1e-6);
  return KeepWarm(workshop, session.key(), mesh.content_hash, std::move(entry));
}

Result<Cost> CompilationCostOf(const RegisteredMesh& mesh, const std::vector<Handle>& handles,
                               const CancelToken& cancel) {
  auto rows = CountRows(mesh, handles, cancel);
  if (rows) return EstimateCompilation(mesh, *rows);
  return CostOfRefused(std::move(rows.error()));
}

Result<Cost> CostOfRefused(Fault fault) {
  const bool gave_up =
      fault.kind == FaultKind::kCancelled || fault.kind == FaultKind::kDeadlineExceeded;
  if (gave_up) return Fail(std::move(fault));
  return Cost{};
}

MeshEntry KeepWarm(Workshop& workshop, const std::string& owner, MeshEntry entry) {
  const std::size_t bytes = entry.mesh->report().bytes;
  entry.mesh = workshop.derived.Keep<RegisteredMesh>(MeshKey(owner, entry.content_hash),
                                                     std::move(entry.mesh), bytes);
  return entry;
}

HandleSetEntry KeepWarm(Workshop& workshop, const store::SessionKey& session,
                        const std::string& blob, HandleSetEntry entry) {
  const std::size_t bytes = entry.handles->bytes();
  auto set = std::make_shared<const CompiledSet>(
      CompiledSet{blob, entry.definitions, std::move(entry.handles)});
  set = workshop.derived.Keep<CompiledSet>(HandleSetKey(session, entry.handle_set_id),
                                           std::move(set), bytes, true);
  entry.handles = HandlesOf(set);
  return entry;
}

}  // namespace arap::app
