// RegisteredMesh: a planar mesh, validated, with both step matrices factored [II09 §6
// "registration"].
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "core/mesh/validation.h"

namespace arap {

class RegisteredMeshParts;

// Immutable, safe to share between threads. Every handle set on the mesh shares its factors.
class RegisteredMesh {
 public:
  // Validates, builds the cells and factors. O(n^1.5) for a planar mesh.
  // Faults: those of ValidatePlanar, kArrayLength and kInvalidOption for the rigidity,
  // kNumerical, and whatever `cancel` answers between the phases.
  static Result<std::shared_ptr<const RegisteredMesh>> Register(PlanarMesh mesh,
                                                                const EnergyOptions& options,
                                                                const MeshLimits& limits = {},
                                                                const CancelToken& cancel = {});
  ~RegisteredMesh();
  RegisteredMesh(const RegisteredMesh&) = delete;
  RegisteredMesh& operator=(const RegisteredMesh&) = delete;

  // The mesh as registered: triangles turned counter-clockwise, positions in units of the input.
  const PlanarMesh& mesh() const;
  const EnergyOptions& options() const;
  const RegistrationReport& report() const;

  // For the rest of this room.
  const RegisteredMeshParts& parts() const { return *parts_; }

 private:
  explicit RegisteredMesh(std::unique_ptr<const RegisteredMeshParts> parts);
  std::unique_ptr<const RegisteredMeshParts> parts_;
};

}  // namespace arap
