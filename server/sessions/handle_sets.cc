#include "server/sessions/handle_sets.h"

#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/names.h"
#include "core/base/try.h"
#include "server/budget/faults.h"
#include "server/runtime/clock.h"
#include "server/runtime/metrics.h"

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

// Keeps what was just computed and stored; `blob` names the mesh that the set was compiled on.
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

// Handles that the core will refuse cost nothing: it says why itself.
Result<Cost> CostOfRefused(Fault fault) {
  const bool gave_up =
      fault.kind == FaultKind::kCancelled || fault.kind == FaultKind::kDeadlineExceeded;
  if (gave_up) return Fail(std::move(fault));
  return Cost{};
}

Result<Cost> CompilationCostOf(const RegisteredMesh& mesh, const std::vector<Handle>& handles,
                               const CancelToken& cancel) {
  auto rows = CountRows(mesh, handles, cancel);
  if (rows) return EstimateCompilation(mesh, *rows);
  return CostOfRefused(std::move(rows.error()));
}

Status CheckCount(std::size_t count, const Limits& limits, std::string field) {
  if (count <= limits.max_handles) return {};
  return Fail(
      Fault(FaultKind::kTooManyHandles,
            fmt::format("The set would have {} handles, more than {}.", count, limits.max_handles))
          .Field(std::move(field))
          .Detail("count", count)
          .Detail("quota", "max_handles")
          .Detail("limit", limits.max_handles));
}

// Whether the record has this very set under the id already. kAlreadyExists for another one,
// kLimitExceeded when there is no room for one more.
Result<bool> HasSet(const store::SessionRecord& record, const std::string& handle_set_id,
                    const std::string& mesh_id, const std::vector<Handle>& definitions,
                    const Limits& limits) {
  const auto found = record.handle_sets.find(handle_set_id);
  if (found != record.handle_sets.end()) {
    const store::HandleSetRecord& set = found->second;
    if (set.mesh_id == mesh_id && *set.definitions == definitions) return true;
    return Fail(Taken("handle set", handle_set_id, "other handles"));
  }
  if (record.handle_sets.size() >= limits.max_handle_sets_per_session) {
    return Fail(QuotaFull("max_handle_sets_per_session", limits.max_handle_sets_per_session));
  }
  return false;
}

// The mesh that a set was compiled on must still be the one under its id.
Status CheckMesh(const store::SessionRecord& record, const MeshEntry& mesh) {
  TRY(const auto now, FindMesh(record, mesh.mesh_id));
  if (now.blob != mesh.content_hash) return Fail(NotFound("mesh", mesh.mesh_id));
  return {};
}

// The definitions after CompiledHandles::Edit with the same arguments.
store::HandleDefinitions Edited(const std::vector<Handle>& definitions,
                                const std::vector<std::string>& remove,
                                const std::vector<Handle>& add) {
  const std::set<std::string_view> gone(remove.begin(), remove.end());
  std::vector<Handle> edited;
  for (const Handle& handle : definitions) {
    if (!gone.contains(handle.id)) edited.push_back(handle);
  }
  edited.insert(edited.end(), add.begin(), add.end());
  return store::MakeDefinitions(std::move(edited));
}

// The number of handles after an edit.
Status CheckEdit(const HandleSetEntry& entry, const std::vector<std::string>& remove,
                 const std::vector<Handle>& add, const Limits& limits) {
  const std::set<std::string_view> gone(remove.begin(), remove.end());
  const std::size_t known = entry.definitions->size();
  const std::size_t left = known > gone.size() ? known - gone.size() : 0;
  return CheckCount(left + add.size(), limits, "add");
}

}  // namespace

Result<HandleSetEntry> CompileHandles(Workshop& workshop, const Caller& caller,
                                      const std::string& session_id, const std::string& mesh_id,
                                      const std::string& handle_set_id,
                                      const std::vector<Handle>& handles,
                                      const CancelToken& cancel) {
  const runtime::WallTimer working;
  const Limits& limits = workshop.limits;
  TRY(const auto session, workshop.sessions.Use(caller.owner, session_id));
  CHECK_OK(CheckName(handle_set_id, "handle_set_id"));
  TRY(const auto known, FindMesh(*session->record(), mesh_id));
  CHECK_OK(CheckCount(handles.size(), limits, "handles"));
  TRY(const bool has, HasSet(*session->record(), handle_set_id, mesh_id, handles, limits));
  if (has) return WarmHandleSet(workshop, caller, *session, handle_set_id, cancel);

  TRY(const auto mesh, WarmMesh(workshop, caller, *session, mesh_id, cancel));
  TRY(const Cost cost, CompilationCostOf(*mesh.mesh, handles, cancel));
  TRY(const auto room, workshop.derived.Reserve(caller, cost.bytes));
  TRY(auto compiled, CompiledHandles::Compile(mesh.mesh, handles, cancel));
  const auto add = [&](store::SessionRecord& record) -> Result<bool> {
    TRY(const bool there, HasSet(record, handle_set_id, mesh_id, handles, limits));
    if (there) return false;
    CHECK_OK(CheckMesh(record, mesh));
    record.handle_sets[handle_set_id] = {mesh_id, store::MakeDefinitions(handles), 1};
    return true;
  };
  TRY(const auto record, workshop.sessions.Change(caller, *session, add));
  const store::HandleSetRecord& set = record->handle_sets.at(handle_set_id);
  auto entry =
      KeepWarm(workshop, session->key(), mesh.content_hash,
               {handle_set_id, mesh_id, set.definitions, std::move(compiled), set.revision});
  workshop.metrics.Phase(runtime::Phase::kCompile, working.Micros() * 1e-6);
  return entry;
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

Result<Cost> EditCostOf(const HandleSetEntry& entry, const std::vector<std::string>& remove,
                        const std::vector<Handle>& add, const Limits& limits,
                        const CancelToken& cancel) {
  CHECK_OK(CheckEdit(entry, remove, add, limits));
  auto rows = CountRows(*entry.handles->mesh(), add, cancel);
  if (rows) return EstimateEdit(*entry.handles, remove, *rows).cost;
  return CostOfRefused(std::move(rows.error()));
}

Result<HandleSetEntry> EditEntry(const HandleSetEntry& entry,
                                 const std::vector<std::string>& remove,
                                 const std::vector<Handle>& add, const Limits& limits,
                                 const CancelToken& cancel) {
  CHECK_OK(CheckEdit(entry, remove, add, limits));
  TRY(auto compiled, entry.handles->Edit(remove, add, cancel));
  return HandleSetEntry{entry.handle_set_id, entry.mesh_id, Edited(*entry.definitions, remove, add),
                        std::move(compiled), entry.revision + 1};
}

Result<HandleSetEntry> EditHandles(Workshop& workshop, const Caller& caller,
                                   const std::string& session_id, const std::string& handle_set_id,
                                   const std::vector<std::string>& remove,
                                   const std::vector<Handle>& add, const CancelToken& cancel) {
  const runtime::WallTimer working;
  TRY(const auto session, workshop.sessions.Use(caller.owner, session_id));
  for (;;) {
    TRY(const auto entry, WarmHandleSet(workshop, caller, *session, handle_set_id, cancel));
    TRY(const Cost cost, EditCostOf(entry, remove, add, workshop.limits, cancel));
    TRY(const auto room, workshop.derived.Reserve(caller, cost.bytes));
    TRY(auto edited, EditEntry(entry, remove, add, workshop.limits, cancel));
    std::string blob;
    const auto replace = [&](store::SessionRecord& record) -> Result<bool> {
      blob.clear();  // once more, after another server was first
      TRY(const auto set, FindHandleSet(record, handle_set_id));
      // Another edit came first, or another set or another mesh has the id now: do this one on
      // that.
      if (set.revision != entry.revision || record.meshes.at(set.mesh_id).blob != entry.blob ||
          !store::SameDefinitions(set.definitions, entry.definitions)) {
        return false;
      }
      blob = record.meshes.at(set.mesh_id).blob;
      record.handle_sets[handle_set_id] = {set.mesh_id, edited.definitions, edited.revision};
      return true;
    };
    TRY(const auto stored, workshop.sessions.Change(caller, *session, replace));
    if (blob.empty()) continue;
    edited = KeepWarm(workshop, session->key(), blob, std::move(edited));
    workshop.metrics.Phase(runtime::Phase::kEdit, working.Micros() * 1e-6);
    return edited;
  }
}

Status DeleteHandleSet(Workshop& workshop, const Caller& caller, const std::string& session_id,
                       const std::string& handle_set_id) {
  TRY(const auto session, workshop.sessions.Use(caller.owner, session_id));
  const auto remove = [&](store::SessionRecord& record) -> Result<bool> {
    if (record.handle_sets.erase(handle_set_id) == 0) {
      return Fail(NotFound("handle set", handle_set_id));
    }
    return true;
  };
  TRY(const auto stored, workshop.sessions.Change(caller, *session, remove));
  workshop.ReleaseHandleSet(session->key(), handle_set_id);
  return {};
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

DerivedKey HandleSetKey(const store::SessionKey& session, const std::string& handle_set_id) {
  // No id has a slash.
  return {session.owner, DerivedKind::kHandleSet, session.id + "/" + handle_set_id};
}

}  // namespace arap::app
