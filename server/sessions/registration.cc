#include "server/sessions/registration.h"

#include <utility>
#include <vector>

#include "core/token/sha256.h"
#include "server/budget/estimate.h"
#include "server/sessions/names.h"
#include "server/sessions/warm.h"
#include "server/store/blobs/mesh_blob.h"

namespace arap::app {
namespace {

constexpr std::size_t kDefaultIdLength = 32;

// Whether the record has this very mesh under the id already. kAlreadyExists for another one,
// kLimitExceeded when there is no room for one more.
Result<bool> HasMesh(const store::SessionRecord& record, const std::string& mesh_id,
                     const std::string& blob, const Limits& limits) {
  if (const auto found = record.meshes.find(mesh_id); found != record.meshes.end()) {
    if (found->second.blob == blob) return true;
    return Fail(Taken("mesh", mesh_id, "another mesh or other options"));
  }
  if (record.meshes.size() >= limits.max_meshes_per_session) {
    return Fail(QuotaFull("max_meshes_per_session", limits.max_meshes_per_session));
  }
  return false;
}

Result<std::shared_ptr<const RegisteredMesh>> Factor(Engine& engine, const Caller& caller,
                                                     PlanarMesh mesh, const EnergyOptions& options,
                                                     const CancelToken& cancel) {
  const MeshLimits limits{engine.limits.max_vertices, engine.limits.max_triangles};
  auto room = engine.derived.Reserve(caller, RegistrationBytes(mesh.vertices.size()));
  if (!room) return Fail(std::move(room.error()));
  return RegisteredMesh::Register(std::move(mesh), options, limits, cancel);
}

}  // namespace

Result<Registration> RegisterMesh(Engine& engine, const Caller& caller,
                                  const std::string& session_id, std::string mesh_id,
                                  PlanarMesh mesh, const EnergyOptions& options,
                                  const CancelToken& cancel) {
  auto session = engine.sessions.Use(caller.owner, session_id);
  if (!session) return Fail(std::move(session.error()));
  if (!mesh_id.empty()) {
    if (auto name = CheckName(mesh_id, "mesh_id"); !name) return Fail(std::move(name.error()));
  }
  const std::string bytes = store::EncodeMesh(mesh, options);
  auto hash = Sha256Hex(bytes);
  if (!hash) return Fail(std::move(hash.error()));
  if (mesh_id.empty()) mesh_id = hash->substr(0, kDefaultIdLength);

  auto has = HasMesh(*(*session)->record(), mesh_id, *hash, engine.limits);
  if (!has) return Fail(std::move(has.error()));
  MeshEntry entry{mesh_id, *hash,
                  engine.derived.Find<RegisteredMesh>(MeshKey(caller.owner, *hash))};
  const bool shared = entry.mesh != nullptr;
  if (!shared) {
    auto made = Factor(engine, caller, std::move(mesh), options, cancel);
    if (!made) return Fail(std::move(made.error()));
    entry.mesh = *std::move(made);
  }
  if (!*has) {
    // The blob first: a record never names what is not there.
    if (auto put = engine.stores.blobs->Put(*hash, bytes); !put) return Fail(put.error());
    auto stored = engine.sessions.Change(caller, **session, [&](store::SessionRecord& record) {
      return HasMesh(record, mesh_id, *hash, engine.limits)
          .and_then([&](bool there) -> Result<bool> {
            if (there) return false;
            record.meshes[mesh_id] = {*hash};
            return true;
          });
    });
    if (!stored) return Fail(std::move(stored.error()));
  }
  return Registration{KeepWarm(engine, caller.owner, std::move(entry)), shared};
}

Status DeleteMesh(Engine& engine, const Caller& caller, const std::string& session_id,
                  const std::string& mesh_id) {
  auto session = engine.sessions.Use(caller.owner, session_id);
  if (!session) return Fail(std::move(session.error()));
  std::string blob;
  std::vector<std::string> sets;
  auto stored =
      engine.sessions.Change(caller, **session, [&](store::SessionRecord& record) -> Result<bool> {
        auto mesh = FindMesh(record, mesh_id);
        if (!mesh) return Fail(std::move(mesh.error()));
        blob = mesh->blob;
        record.meshes.erase(mesh_id);
        sets.clear();
        std::erase_if(record.handle_sets, [&](const auto& set) {
          if (set.second.mesh_id != mesh_id) return false;
          sets.push_back(set.first);
          return true;
        });
        return true;
      });
  if (!stored) return Fail(std::move(stored.error()));
  for (const std::string& set : sets) engine.ReleaseHandleSet((*session)->key(), set);
  engine.ReleaseMesh(caller.owner, blob);
  return {};
}

}  // namespace arap::app
