#include "server/app/handle_sets.h"

#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "server/app/definitions.h"
#include "server/app/names.h"

namespace arap::app {
namespace {

Status CheckCount(std::size_t count, const Limits& limits, std::string field) {
  if (count <= limits.max_handles) return {};
  Fault fault{
      FaultKind::kTooManyHandles,
      fmt::format("The set would have {} handles, more than {}.", count, limits.max_handles),
      {},
      {},
      std::move(field)};
  fault.Detail("count", std::to_string(count)).Detail("quota", "max_handles");
  return Fail(fault.Detail("limit", std::to_string(limits.max_handles)));
}

// The core numbers the added handles as "handles[i]"; in an edit they are the field "add".
std::string FieldOfEdit(const std::string& field) {
  constexpr std::string_view kHandles = "handles[";
  return field.starts_with(kHandles) ? "add[" + field.substr(kHandles.size()) : field;
}

}  // namespace

Result<HandleSetEntry> CompileHandles(Engine& engine, const std::string& session_id,
                                      const std::string& mesh_id, const std::string& handle_set_id,
                                      const std::vector<Handle>& handles,
                                      const CancelToken& cancel) {
  auto session = engine.sessions.Use(session_id);
  if (!session) return Fail(std::move(session.error()));
  if (auto name = CheckName(handle_set_id, "handle_set_id"); !name) {
    return Fail(std::move(name.error()));
  }
  auto mesh = (*session)->FindMesh(mesh_id);
  if (!mesh) return Fail(std::move(mesh.error()));
  if (auto count = CheckCount(handles.size(), engine.limits, "handles"); !count) {
    return Fail(std::move(count.error()));
  }
  auto offer = (*session)->OfferHandleSet(handle_set_id, mesh_id, handles, engine.limits);
  if (!offer) return Fail(std::move(offer.error()));
  if (*offer) return **std::move(offer);

  auto compiled = CompiledHandles::Compile(mesh->mesh, handles, cancel);
  if (!compiled) return Fail(std::move(compiled.error()));
  return (*session)->AddHandleSet({handle_set_id, mesh_id, handles, *std::move(compiled), 1},
                                  engine.limits);
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

Result<HandleSetEntry> EditHandles(Engine& engine, const std::string& session_id,
                                   const std::string& handle_set_id,
                                   const std::vector<std::string>& remove,
                                   const std::vector<Handle>& add, const CancelToken& cancel) {
  auto session = engine.sessions.Use(session_id);
  if (!session) return Fail(std::move(session.error()));
  for (;;) {
    auto entry = (*session)->FindHandleSet(handle_set_id);
    if (!entry) return entry;
    auto edited = EditEntry(*entry, remove, add, engine.limits, cancel);
    if (!edited) return edited;
    auto stored = (*session)->ReplaceHandleSet(*edited);
    if (!stored) return Fail(std::move(stored.error()));
    if (*stored) return edited;
    // Another edit came first: do this one on its result.
  }
}

}  // namespace arap::app
