// Meshes: how one enters a session, sharing the factors of an equal one, and leaves it.
#pragma once

#include <string>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "server/access/caller.h"
#include "server/sessions/workshop.h"

namespace arap::app {

struct Registration {
  MeshEntry entry;
  bool shared = false;  // the factors were there already
};

// Validates and factors `mesh`, or finds it done, and stores it before it answers. An empty
// `mesh_id` stands for the first 32 digits of the content hash. Takes as long as the factorisation:
// for the job lane. Faults: kInvalidName, kNotFound, kMeshTooLarge, kAlreadyExists, kLimitExceeded,
// those of RegisteredMesh::Register and of the store; nothing is kept then.
Result<Registration> RegisterMesh(Workshop& workshop, const Caller& caller,
                                  const std::string& session_id, std::string mesh_id,
                                  PlanarMesh mesh, const EnergyOptions& options,
                                  const CancelToken& cancel);

// Forgets it and the handle sets on it. kNotFound.
Status DeleteMesh(Workshop& workshop, const Caller& caller, const std::string& session_id,
                  const std::string& mesh_id);

}  // namespace arap::app
