#include "server/sessions/handle_sets.h"

#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "server/budget/estimate.h"
#include "server/sessions/definitions.h"
#include "server/sessions/names.h"
#include "server/sessions/warm.h"

namespace arap::app {
namespace {

Status CheckCount(std::size_t count, const Limits& limits, std::string field) {
  if (count <= limits.max_handles) return {};
  Fault fault =
      Fault(FaultKind::kTooManyHandles,
            fmt::format("The set would have {} handles, more than {}.", count, limits.max_handles))
          .Field(std::move(field));
  fault.Detail("count", std::to_string(count)).Detail("quota", "max_handles");
  return Fail(fault.Detail("limit", std::to_string(limits.max_handles)));
}

// Whether the record has this very set under the id already. kAlreadyExists for another one,
// kLimitExceeded when there is no room for one more.
Result<bool> HasSet(const store::SessionRecord& record, const std::string& handle_set_id,
                    const std::string& mesh_id, const std::vector<Handle>& definitions,
                    const Limits& limits) {
  const auto found = record.handle_sets.find(handle_set_id);
  if (found != record.handle_sets.end()) {
    const store::HandleSetRecord& set = found->second;
    if (set.mesh_id == mesh_id && SameDefinitions(set.definitions, definitions)) return true;
    return Fail(Taken("handle set", handle_set_id, "other handles"));
  }
  if (record.handle_sets.size() >= limits.max_handle_sets_per_session) {
    return Fail(QuotaFull("max_handle_sets_per_session", limits.max_handle_sets_per_session));
  }
  return false;
}

// The mesh that a set was compiled on must still be the one under its id.
Status CheckMesh(const store::SessionRecord& record, const MeshEntry& mesh) {
  auto now = FindMesh(record, mesh.mesh_id);
  if (!now) return Fail(std::move(now.error()));
  if (now->blob != mesh.content_hash) return Fail(NotFound("mesh", mesh.mesh_id));
  return {};
}

// The core numbers the added handles as "handles[i]"; in an edit they are the field "add".
std::string FieldOfEdit(const std::string& field) {
  constexpr std::string_view kHandles = "handles[";
  return field.starts_with(kHandles) ? "add[" + field.substr(kHandles.size()) : field;
}

}  // namespace

Result<HandleSetEntry> CompileHandles(Engine& engine, const Caller& caller,
                                      const std::string& session_id, const std::string& mesh_id,
                                      const std::string& handle_set_id,
                                      const std::vector<Handle>& handles,
                                      const CancelToken& cancel) {
  auto session = engine.sessions.Use(caller.owner, session_id);
  if (!session) return Fail(std::move(session.error()));
  if (auto name = CheckName(handle_set_id, "handle_set_id"); !name) {
    return Fail(std::move(name.error()));
  }
  auto known = FindMesh(*(*session)->record(), mesh_id);
  if (!known) return Fail(std::move(known.error()));
  if (auto count = CheckCount(handles.size(), engine.limits, "handles"); !count) {
    return Fail(std::move(count.error()));
  }
  auto has = HasSet(*(*session)->record(), handle_set_id, mesh_id, handles, engine.limits);
  if (!has) return Fail(std::move(has.error()));
  if (*has) return WarmHandleSet(engine, caller, **session, handle_set_id, cancel);

  auto mesh = WarmMesh(engine, caller, **session, mesh_id, cancel);
  if (!mesh) return Fail(std::move(mesh.error()));
  const std::size_t vertices = mesh->mesh->mesh().vertices.size();
  auto room = engine.derived.Reserve(caller, CompilationBytes(vertices, RowsOf(handles, vertices)));
  if (!room) return Fail(std::move(room.error()));
  auto compiled = CompiledHandles::Compile(mesh->mesh, handles, cancel);
  if (!compiled) return Fail(std::move(compiled.error()));
  auto stored = engine.sessions.Change(caller, **session, [&](store::SessionRecord& record) {
    return HasSet(record, handle_set_id, mesh_id, handles, engine.limits)
        .and_then([&](bool there) -> Result<bool> {
          if (there) return false;
          if (auto good = CheckMesh(record, *mesh); !good) return Fail(good.error());
          record.handle_sets[handle_set_id] = {mesh_id, handles, 1};
          return true;
        });
  });
  if (!stored) return Fail(std::move(stored.error()));
  return KeepWarm(engine, (*session)->key(), mesh->content_hash,
                  {handle_set_id, mesh_id, handles, *std::move(compiled),
                   (*stored)->handle_sets.at(handle_set_id).revision});
}

Result<HandleSetEntry> EditEntry(const HandleSetEntry& entry,
                                 const std::vector<std::string>& remove,
                                 const std::vector<Handle>& add, const Limits& limits,
                                 const CancelToken& cancel) {
  const std::set<std::string_view> gone(remove.begin(), remove.end());
  const std::size_t known = entry.definitions.size();
  const std::size_t left = known > gone.size() ? known - gone.size() : 0;
  if (auto count = CheckCount(left + add.size(), limits, "add"); !count) {
    return Fail(std::move(count.error()));
  }
  auto compiled = entry.handles->Edit(remove, add, cancel);
  if (!compiled) {
    compiled.error().Field(FieldOfEdit(compiled.error().field));
    return Fail(std::move(compiled.error()));
  }
  return HandleSetEntry{entry.handle_set_id, entry.mesh_id,
                        EditDefinitions(entry.definitions, remove, add), *std::move(compiled),
                        entry.revision + 1};
}

Result<HandleSetEntry> EditHandles(Engine& engine, const Caller& caller,
                                   const std::string& session_id, const std::string& handle_set_id,
                                   const std::vector<std::string>& remove,
                                   const std::vector<Handle>& add, const CancelToken& cancel) {
  auto session = engine.sessions.Use(caller.owner, session_id);
  if (!session) return Fail(std::move(session.error()));
  for (;;) {
    auto entry = WarmHandleSet(engine, caller, **session, handle_set_id, cancel);
    if (!entry) return entry;
    const std::size_t vertices = entry->handles->mesh()->mesh().vertices.size();
    auto room = engine.derived.Reserve(
        caller, CompilationBytes(vertices, entry->handles->rows() + RowsOf(add, vertices)));
    if (!room) return Fail(std::move(room.error()));
    auto edited = EditEntry(*entry, remove, add, engine.limits, cancel);
    if (!edited) return edited;
    std::string blob;
    auto stored = engine.sessions.Change(
        caller, **session, [&](store::SessionRecord& record) -> Result<bool> {
          auto set = FindHandleSet(record, handle_set_id);
          if (!set) return Fail(std::move(set.error()));
          // Another edit came first, or another set has the id now: do this one on that.
          if (set->revision != entry->revision ||
              !SameDefinitions(set->definitions, entry->definitions)) {
            return false;
          }
          blob = record.meshes.at(set->mesh_id).blob;
          record.handle_sets[handle_set_id] = {set->mesh_id, edited->definitions, edited->revision};
          return true;
        });
    if (!stored) return Fail(std::move(stored.error()));
    if (!blob.empty()) return KeepWarm(engine, (*session)->key(), blob, *std::move(edited));
  }
}

Status DeleteHandleSet(Engine& engine, const Caller& caller, const std::string& session_id,
                       const std::string& handle_set_id) {
  auto session = engine.sessions.Use(caller.owner, session_id);
  if (!session) return Fail(std::move(session.error()));
  auto stored =
      engine.sessions.Change(caller, **session, [&](store::SessionRecord& record) -> Result<bool> {
        if (record.handle_sets.erase(handle_set_id) == 0) {
          return Fail(NotFound("handle set", handle_set_id));
        }
        return true;
      });
  if (!stored) return Fail(std::move(stored.error()));
  engine.ReleaseHandleSet((*session)->key(), handle_set_id);
  return {};
}

}  // namespace arap::app
