#include "server/sessions/warm.h"

#include <limits>
#include <memory>
#include <utility>

#include "server/budget/estimate.h"
#include "server/runtime/metrics.h"
#include "server/runtime/stopwatch.h"
#include "server/sessions/definitions.h"
#include "server/sessions/names.h"
#include "server/store/blobs/mesh_blob.h"

namespace arap::app {
namespace {

// A compiled set, and what tells whether it is the one that a record means: another process may
// have changed the set under its id.
struct CompiledSet {
  std::string blob;
  std::vector<Handle> definitions;
  std::shared_ptr<const CompiledHandles> handles;
};

bool IsOf(const CompiledSet& set, const store::HandleSetRecord& record, const std::string& blob) {
  return set.blob == blob && SameDefinitions(set.definitions, record.definitions);
}

// The handles, holding what is kept: so that it counts as in use.
std::shared_ptr<const CompiledHandles> HandlesOf(const std::shared_ptr<const CompiledSet>& set) {
  return {set, set->handles.get()};
}

// What is damaged must say whose it is.
Fault Lost(Fault fault, const std::string& mesh_id) {
  if (fault.kind == FaultKind::kDataLoss) {
    fault.message = "The stored mesh " + Quote(mesh_id) + " cannot be read: " + fault.message;
    fault.Detail("mesh", mesh_id);
  }
  return fault;
}

Result<std::shared_ptr<const RegisteredMesh>> Rebuild(Engine& engine, const Caller& caller,
                                                      const std::string& blob,
                                                      const CancelToken& cancel) {
  auto bytes = engine.stores.blobs->Get(blob);
  if (!bytes) return Fail(std::move(bytes.error()));
  auto stored = store::DecodeMesh(*bytes);
  if (!stored) return Fail(std::move(stored.error()));
  bytes->clear();
  bytes->shrink_to_fit();
  auto room = engine.derived.Reserve(caller, RegistrationBytes(stored->mesh.vertices.size()));
  if (!room) return Fail(std::move(room.error()));
  // What was accepted once stays, also when the limits have shrunk since.
  constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
  const runtime::Stopwatch working;
  auto mesh =
      RegisteredMesh::Register(std::move(stored->mesh), stored->options, {kAny, kAny}, cancel);
  if (mesh) engine.metrics.Phase(runtime::Phase::kRebuild, working.Micros() * 1e-6);
  return mesh;
}

}  // namespace

DerivedKey MeshKey(const std::string& owner, const std::string& blob) {
  return {owner, DerivedKind::kMesh, blob};
}

DerivedKey HandleSetKey(const store::SessionKey& session, const std::string& handle_set_id) {
  // No name has a slash.
  return {session.owner, DerivedKind::kHandleSet, session.id + "/" + handle_set_id};
}

bool IsWarmMesh(Engine& engine, const Session& session, const std::string& mesh_id) {
  const auto record = session.record();
  const auto mesh = record->meshes.find(mesh_id);
  return mesh == record->meshes.end() ||
         engine.derived.Has(MeshKey(record->key.owner, mesh->second.blob));
}

bool IsWarmHandleSet(Engine& engine, const Session& session, const std::string& handle_set_id) {
  const auto record = session.record();
  const auto set = record->handle_sets.find(handle_set_id);
  if (set == record->handle_sets.end()) return true;
  const auto kept = engine.derived.Peek<CompiledSet>(HandleSetKey(record->key, handle_set_id));
  return kept && IsOf(*kept, set->second, record->meshes.at(set->second.mesh_id).blob);
}

Result<MeshEntry> WarmMesh(Engine& engine, const Caller& caller, const Session& session,
                           const std::string& mesh_id, const CancelToken& cancel) {
  auto mesh = FindMesh(*session.record(), mesh_id);
  if (!mesh) return Fail(std::move(mesh.error()));
  const DerivedKey key = MeshKey(session.key().owner, mesh->blob);
  if (auto kept = engine.derived.Find<RegisteredMesh>(key)) {
    return MeshEntry{mesh_id, mesh->blob, std::move(kept)};
  }
  auto rebuilt = Rebuild(engine, caller, mesh->blob, cancel);
  if (!rebuilt) return Fail(Lost(std::move(rebuilt.error()), mesh_id));
  return KeepWarm(engine, session.key().owner, {mesh_id, mesh->blob, *std::move(rebuilt)});
}

Result<HandleSetEntry> WarmHandleSet(Engine& engine, const Caller& caller, const Session& session,
                                     const std::string& handle_set_id, const CancelToken& cancel) {
  const auto record = session.record();
  auto set = FindHandleSet(*record, handle_set_id);
  if (!set) return Fail(std::move(set.error()));
  const std::string& blob = record->meshes.at(set->mesh_id).blob;
  HandleSetEntry entry{handle_set_id, set->mesh_id, {}, nullptr, set->revision};
  const auto kept = engine.derived.Find<CompiledSet>(HandleSetKey(session.key(), handle_set_id));
  if (kept && IsOf(*kept, *set, blob)) {
    entry.definitions = std::move(set->definitions);
    entry.handles = HandlesOf(kept);
    return entry;
  }
  auto mesh = WarmMesh(engine, caller, session, set->mesh_id, cancel);
  if (!mesh) return Fail(std::move(mesh.error()));
  const std::size_t vertices = mesh->mesh->mesh().vertices.size();
  auto room = engine.derived.Reserve(
      caller, CompilationBytes(vertices, RowsOf(set->definitions, vertices)));
  if (!room) return Fail(std::move(room.error()));
  const runtime::Stopwatch working;
  auto compiled = CompiledHandles::Compile(mesh->mesh, set->definitions, cancel);
  if (!compiled) return Fail(std::move(compiled.error()));
  engine.metrics.Phase(runtime::Phase::kRebuild, working.Micros() * 1e-6);
  entry.definitions = std::move(set->definitions);
  entry.handles = *std::move(compiled);
  return KeepWarm(engine, session.key(), mesh->content_hash, std::move(entry));
}

MeshEntry KeepWarm(Engine& engine, const std::string& owner, MeshEntry entry) {
  const std::size_t bytes = entry.mesh->report().bytes;
  entry.mesh = engine.derived.Keep<RegisteredMesh>(MeshKey(owner, entry.content_hash),
                                                   std::move(entry.mesh), bytes);
  return entry;
}

HandleSetEntry KeepWarm(Engine& engine, const store::SessionKey& session, const std::string& blob,
                        HandleSetEntry entry) {
  const std::size_t bytes = entry.handles->bytes();
  auto set = std::make_shared<const CompiledSet>(
      CompiledSet{blob, entry.definitions, std::move(entry.handles)});
  set = engine.derived.Keep<CompiledSet>(HandleSetKey(session, entry.handle_set_id), std::move(set),
                                         bytes, true);
  entry.handles = HandlesOf(set);
  return entry;
}

}  // namespace arap::app
