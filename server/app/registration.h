// Registration: a mesh enters a session, sharing the factors of an equal one.
#pragma once

#include <string>

#include "core/base/cancel.h"
#include "core/base/result.h"
#include "core/energy/options.h"
#include "core/mesh/mesh.h"
#include "server/app/engine.h"
#include "server/app/session.h"

namespace arap::app {

struct Registration {
  MeshEntry entry;
  bool shared = false;  // the factors were there already
};

// Validates and factors `mesh`, or finds it done. An empty `mesh_id` stands for the first 32 digits
// of the content hash. Takes as long as the factorisation: for the job lane. Faults: kInvalidName,
// kNotFound, kMeshTooLarge, kAlreadyExists, kLimitExceeded and those of RegisteredMesh::Register;
// nothing is kept then.
Result<Registration> RegisterMesh(Engine& engine, const std::string& session_id,
                                  std::string mesh_id, PlanarMesh mesh,
                                  const EnergyOptions& options, const CancelToken& cancel);

}  // namespace arap::app
