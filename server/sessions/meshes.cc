#include "server/sessions/meshes.h"

#include <utility>
#include <vector>

#include "arap/core/cost.h"
#include "core/base/names.h"
#include "core/base/try.h"
#include "core/token/digest.h"
#include "server/budget/faults.h"
#include "server/runtime/clock.h"
#include "server/runtime/metrics.h"
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

Result<std::shared_ptr<const RegisteredMesh>> Factor(Workshop& workshop, const Caller& caller,
                                                     PlanarMesh mesh, const EnergyOptions& options,
                                                     const CancelToken& cancel) {
  const MeshLimits limits{workshop.limits.max_vertices, workshop.limits.max_triangles};
  // Before memory is taken: what is asked amiss stays so however much room there is.
  CHECK_OK(RegisteredMesh::CheckOptions(options, mesh.triangles.size()));
  TRY(const auto room,
      workshop.derived.Reserve(caller,
                               EstimateRegistration(mesh.vertices.size(), options.basis).bytes));
  return RegisteredMesh::Register(std::move(mesh), options, limits, cancel);
}

}  // namespace

Result<Registration> RegisterMesh(Workshop& workshop, const Caller& caller,
                                  const std::string& session_id, std::string mesh_id,
                                  PlanarMesh mesh, const EnergyOptions& options,
                                  const CancelToken& cancel) {
  const runtime::WallTimer working;
  TRY(const auto session, workshop.sessions.Use(caller.owner, session_id));
  if (!mesh_id.empty()) CHECK_OK(CheckName(mesh_id, "mesh_id"));
  const std::string bytes = store::EncodeMesh(mesh, options);
  TRY(const std::string hash, Sha256Hex(bytes));
  if (mesh_id.empty()) mesh_id = hash.substr(0, kDefaultIdLength);

  TRY(const bool has, HasMesh(*session->record(), mesh_id, hash, workshop.limits));
  MeshEntry entry{mesh_id, hash,
                  workshop.derived.Find<RegisteredMesh>(MeshKey(caller.owner, hash))};
  const bool shared = entry.mesh != nullptr;
  if (!shared) {
    TRY(entry.mesh, Factor(workshop, caller, std::move(mesh), options, cancel));
  }
  if (!has) {
    // The blob first: a record never names what is not there.
    CHECK_OK(workshop.stores.blobs->Put(hash, bytes));
    const auto add = [&](store::SessionRecord& record) -> Result<bool> {
      TRY(const bool there, HasMesh(record, mesh_id, hash, workshop.limits));
      if (!there) record.meshes[mesh_id] = {hash, bytes.size()};
      return !there;
    };
    TRY(const auto stored, workshop.sessions.Change(caller, *session, add));
  }
  entry = KeepWarm(workshop, caller.owner, std::move(entry));
  if (!shared) workshop.metrics.Phase(runtime::Phase::kRegister, working.Micros() * 1e-6);
  return Registration{std::move(entry), shared};
}

Status DeleteMesh(Workshop& workshop, const Caller& caller, const std::string& session_id,
                  const std::string& mesh_id) {
  TRY(const auto session, workshop.sessions.Use(caller.owner, session_id));
  std::string blob;
  std::vector<std::string> sets;
  const auto remove = [&](store::SessionRecord& record) -> Result<bool> {
    TRY(const auto mesh, FindMesh(record, mesh_id));
    blob = mesh.blob;
    record.meshes.erase(mesh_id);
    sets.clear();
    std::erase_if(record.handle_sets, [&](const auto& set) {
      if (set.second.mesh_id != mesh_id) return false;
      sets.push_back(set.first);
      return true;
    });
    return true;
  };
  TRY(const auto stored, workshop.sessions.Change(caller, *session, remove));
  for (const std::string& set : sets) workshop.ReleaseHandleSet(session->key(), set);
  workshop.ReleaseMesh(caller.owner, blob);
  return {};
}

}  // namespace arap::app
