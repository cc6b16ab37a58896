#include "server/app/registration.h"

#include <utility>

#include "server/app/names.h"
#include "server/runtime/sha256.h"
#include "server/store/mesh_blob.h"

namespace arap::app {
namespace {

constexpr std::size_t kDefaultIdLength = 32;

}  // namespace

Result<Registration> RegisterMesh(Engine& engine, const std::string& session_id,
                                  std::string mesh_id, PlanarMesh mesh,
                                  const EnergyOptions& options, const CancelToken& cancel) {
  auto session = engine.sessions.Use(session_id);
  if (!session) return Fail(std::move(session.error()));
  if (!mesh_id.empty()) {
    if (auto name = CheckName(mesh_id, "mesh_id"); !name) return Fail(std::move(name.error()));
  }
  auto hash = runtime::Sha256Hex(store::EncodeMesh(mesh, options));
  if (!hash) return Fail(std::move(hash.error()));
  if (mesh_id.empty()) mesh_id = hash->substr(0, kDefaultIdLength);

  auto offer = (*session)->OfferMesh(mesh_id, *hash, engine.limits);
  if (!offer) return Fail(std::move(offer.error()));
  if (*offer) return Registration{**std::move(offer), true};

  std::shared_ptr<const RegisteredMesh> registered = engine.meshes.Find(*hash);
  const bool shared = registered != nullptr;
  if (!shared) {
    const MeshLimits limits{engine.limits.max_vertices, engine.limits.max_triangles};
    auto made = RegisteredMesh::Register(std::move(mesh), options, limits, cancel);
    if (!made) return Fail(std::move(made.error()));
    registered = engine.meshes.Share(*hash, *std::move(made));
  }
  auto entry = (*session)->AddMesh({mesh_id, *hash, std::move(registered)}, engine.limits);
  if (!entry) return Fail(std::move(entry.error()));
  return Registration{*std::move(entry), shared};
}

}  // namespace arap::app
