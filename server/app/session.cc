#include "server/app/session.h"

#include <utility>

#include <fmt/format.h>

#include "server/app/definitions.h"
#include "server/app/names.h"

namespace arap::app {
namespace {

Fault Taken(const char* what, const std::string& id, const char* by) {
  Fault fault{FaultKind::kAlreadyExists,
              fmt::format("The {} id {} is in use with {}.", what, Quote(id), by),
              {},
              {},
              {}};
  return fault.Detail("resource", what).Detail("id", id);
}

}  // namespace

Session::Session(SessionSpec spec, const runtime::Clock& clock)
    : spec_(std::move(spec)),
      clock_(clock),
      created_(clock.WallNow()),
      expires_(clock.SteadyNow() + spec_.ttl) {}

SessionView Session::View() const {
  const std::lock_guard lock(mutex_);
  const auto left = expires_ - clock_.SteadyNow();
  SessionView view{spec_,
                   created_,
                   clock_.WallNow() + std::chrono::duration_cast<std::chrono::milliseconds>(left),
                   {},
                   {}};
  for (const auto& [id, entry] : meshes_) view.mesh_ids.push_back(id);
  for (const auto& [id, entry] : handle_sets_) view.handle_set_ids.push_back(id);
  return view;
}

Status Session::CheckAliveLocked() const {
  if (ended_ || clock_.SteadyNow() >= expires_) return Fail(NotFound("session", spec_.id));
  return {};
}

Status Session::Touch() {
  const std::lock_guard lock(mutex_);
  if (auto alive = CheckAliveLocked(); !alive) return alive;
  expires_ = clock_.SteadyNow() + spec_.ttl;
  return {};
}

bool Session::expired() const {
  const std::lock_guard lock(mutex_);
  return clock_.SteadyNow() >= expires_;
}

void Session::End() {
  std::map<std::uint64_t, Listener> listeners;
  std::map<std::string, MeshEntry> meshes;            // freed after the lock
  std::map<std::string, HandleSetEntry> handle_sets;  // likewise
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    listeners.swap(listeners_);
    meshes.swap(meshes_);
    handle_sets.swap(handle_sets_);
  }
  for (const auto& [id, listener] : listeners) listener();
}

std::uint64_t Session::AddEndListener(Listener listener) {
  {
    const std::lock_guard lock(mutex_);
    if (!ended_) {
      const std::uint64_t id = next_listener_++;
      listeners_.emplace(id, std::move(listener));
      return id;
    }
  }
  listener();
  return 0;
}

void Session::RemoveEndListener(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  listeners_.erase(id);
}

Result<MeshEntry> Session::FindMesh(const std::string& mesh_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = meshes_.find(mesh_id);
  if (found == meshes_.end()) return Fail(NotFound("mesh", mesh_id));
  return found->second;
}

Result<std::optional<MeshEntry>> Session::OfferMeshLocked(const std::string& mesh_id,
                                                          const std::string& hash,
                                                          const Limits& limits) const {
  if (auto alive = CheckAliveLocked(); !alive) return Fail(alive.error());
  if (const auto found = meshes_.find(mesh_id); found != meshes_.end()) {
    if (found->second.content_hash == hash) return found->second;
    return Fail(Taken("mesh", mesh_id, "another mesh or other options"));
  }
  if (meshes_.size() >= limits.max_meshes_per_session) {
    return Fail(QuotaFull("max_meshes_per_session", limits.max_meshes_per_session));
  }
  return std::nullopt;
}

Result<std::optional<MeshEntry>> Session::OfferMesh(const std::string& mesh_id,
                                                    const std::string& hash,
                                                    const Limits& limits) const {
  const std::lock_guard lock(mutex_);
  return OfferMeshLocked(mesh_id, hash, limits);
}

Result<MeshEntry> Session::AddMesh(MeshEntry entry, const Limits& limits) {
  const std::lock_guard lock(mutex_);
  auto offer = OfferMeshLocked(entry.mesh_id, entry.content_hash, limits);
  if (!offer) return Fail(std::move(offer.error()));
  if (*offer) return **std::move(offer);
  meshes_.emplace(entry.mesh_id, entry);
  return entry;
}

Status Session::DeleteMesh(const std::string& mesh_id) {
  std::vector<MeshEntry> mesh;             // freed after the lock
  std::vector<HandleSetEntry> dependents;  // likewise
  const std::lock_guard lock(mutex_);
  const auto found = meshes_.find(mesh_id);
  if (found == meshes_.end()) return Fail(NotFound("mesh", mesh_id));
  mesh.push_back(std::move(found->second));
  meshes_.erase(found);
  for (auto set = handle_sets_.begin(); set != handle_sets_.end();) {
    if (set->second.mesh_id != mesh_id) {
      ++set;
      continue;
    }
    dependents.push_back(std::move(set->second));
    set = handle_sets_.erase(set);
  }
  return {};
}

Result<HandleSetEntry> Session::FindHandleSet(const std::string& handle_set_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = handle_sets_.find(handle_set_id);
  if (found == handle_sets_.end()) return Fail(NotFound("handle set", handle_set_id));
  return found->second;
}

Result<std::optional<HandleSetEntry>> Session::OfferHandleSetLocked(
    const std::string& handle_set_id, const std::string& mesh_id,
    const std::vector<Handle>& definitions, const Limits& limits) const {
  if (auto alive = CheckAliveLocked(); !alive) return Fail(alive.error());
  if (const auto found = handle_sets_.find(handle_set_id); found != handle_sets_.end()) {
    const HandleSetEntry& entry = found->second;
    if (entry.mesh_id == mesh_id && SameDefinitions(entry.definitions, definitions)) return entry;
    return Fail(Taken("handle set", handle_set_id, "other handles"));
  }
  if (handle_sets_.size() >= limits.max_handle_sets_per_session) {
    return Fail(QuotaFull("max_handle_sets_per_session", limits.max_handle_sets_per_session));
  }
  return std::nullopt;
}

Result<std::optional<HandleSetEntry>> Session::OfferHandleSet(
    const std::string& handle_set_id, const std::string& mesh_id,
    const std::vector<Handle>& definitions, const Limits& limits) const {
  const std::lock_guard lock(mutex_);
  return OfferHandleSetLocked(handle_set_id, mesh_id, definitions, limits);
}

Result<HandleSetEntry> Session::AddHandleSet(HandleSetEntry entry, const Limits& limits) {
  const std::lock_guard lock(mutex_);
  auto offer = OfferHandleSetLocked(entry.handle_set_id, entry.mesh_id, entry.definitions, limits);
  if (!offer) return Fail(std::move(offer.error()));
  if (*offer) return **std::move(offer);
  const auto mesh = meshes_.find(entry.mesh_id);
  if (mesh == meshes_.end() || mesh->second.mesh != entry.handles->mesh()) {
    return Fail(NotFound("mesh", entry.mesh_id));
  }
  handle_sets_.emplace(entry.handle_set_id, entry);
  return entry;
}

Result<bool> Session::ReplaceHandleSet(const HandleSetEntry& entry) {
  HandleSetEntry old;  // freed after the lock
  const std::lock_guard lock(mutex_);
  const auto found = handle_sets_.find(entry.handle_set_id);
  if (found == handle_sets_.end()) return Fail(NotFound("handle set", entry.handle_set_id));
  HandleSetEntry& stored = found->second;
  if (stored.revision + 1 != entry.revision || stored.mesh_id != entry.mesh_id) return false;
  old = std::exchange(stored, entry);
  return true;
}

Status Session::DeleteHandleSet(const std::string& handle_set_id) {
  HandleSetEntry old;  // freed after the lock
  const std::lock_guard lock(mutex_);
  const auto found = handle_sets_.find(handle_set_id);
  if (found == handle_sets_.end()) return Fail(NotFound("handle set", handle_set_id));
  old = std::move(found->second);
  handle_sets_.erase(found);
  return {};
}

}  // namespace arap::app
