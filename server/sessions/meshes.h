// Meshes: how one enters a session, sharing the factors of an equal one, how it is found again, or
// registered again from its blob after it was evicted, after a restart or on another replica, and
// how it leaves.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/core/registered_mesh.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "arap/model/outline.h"
#include "arap/model/repair.h"
#include "server/access/caller.h"
#include "server/budget/derived_cache.h"
#include "server/sessions/session.h"
#include "server/sessions/workshop.h"

namespace arap::app {

// A mesh under the id that the client gave it.
struct MeshEntry {
  std::string mesh_id;
  std::string content_hash;  // also the name of its blob
  std::shared_ptr<const RegisteredMesh> mesh;
};

struct Registration {
  MeshEntry entry;
  bool shared = false;  // the factors were there already
};

// Mends, validates and factors `mesh`, or finds it done, and stores it before it answers. An empty
// `mesh_id` stands for the first 32 digits of the content hash. Takes as long as the factorisation:
// for the job lane. Faults: kInvalidName, kNotFound, kMeshTooLarge, kAlreadyExists, kLimitExceeded,
// those of RegisteredMesh::Register and of the store; nothing is kept then.
Result<Registration> RegisterMesh(Workshop& workshop, const Caller& caller,
                                  const std::string& session_id, std::string mesh_id,
                                  PlanarMesh mesh, const EnergyOptions& options,
                                  const CancelToken& cancel, const RepairOptions& repairs = {});

// Triangles inside outlines (core/outline/shape.h, quality_mesh.h), in memory that is reserved for
// the caller: about as many vertices as are asked for, and no more than a few times as many as that
// and the outlines have points. Takes about ExpectMeshing seconds: for the job lane. Faults: those
// of arap::ShapeOutlines and arap::MeshOutlines with the field, kInvalidOption for the vertices,
// kLimitExceeded when the memory is not to be had.
Result<QualityMesh> MeshOutlines(Workshop& workshop, const Caller& caller,
                                 const std::vector<Outline>& outlines,
                                 const OutlineOptions& options, const CancelToken& cancel);
// Of outlines of so many points.
double ExpectMeshing(std::size_t points, const OutlineOptions& options);

// The entry. When it is not warm this takes as long as the registration: for the job lane. Faults:
// kNotFound; kDataLoss for a blob that is missing or damaged; kLimitExceeded when the memory is not
// to be had; kStoreUnavailable; and what `cancel` answers.
Result<MeshEntry> WarmMesh(Workshop& workshop, const Caller& caller, const Session& session,
                           const std::string& mesh_id, const CancelToken& cancel);

// Forgets it and the handle sets on it. kNotFound.
Status DeleteMesh(Workshop& workshop, const Caller& caller, const std::string& session_id,
                  const std::string& mesh_id);

// What the next call finds in the cache.
enum class Warmth {
  kMissing,  // there is no such thing: to say so is quick
  kCold,     // it has to be computed again
  kWarm,
};
struct PeekedMesh {
  Warmth warmth = Warmth::kMissing;
  std::shared_ptr<const RegisteredMesh> mesh;  // kWarm
};
// Never blocks and counts no look-up.
PeekedMesh PeekMesh(Workshop& workshop, const Session& session, const std::string& mesh_id);

// Under this key the cache keeps the mesh of a blob.
DerivedKey MeshKey(const std::string& owner, const std::string& blob);

// The blob of a mesh: the input of a registration.
struct MeshBlob {
  PlanarMesh mesh;
  EnergyOptions options;
  RepairOptions repairs;
};

// A version tag, basis, weights, then rigidity, vertices and triangles, each behind its length; all
// numbers in the byte order of the machine. With repairs another tag, and what they are behind the
// weights. Equal arguments give equal bytes.
std::string EncodeMesh(const PlanarMesh& mesh, const EnergyOptions& options,
                       const RepairOptions& repairs = {});

// kDataLoss for bytes that EncodeMesh did not write.
Result<MeshBlob> DecodeMesh(std::string_view bytes);

}  // namespace arap::app
