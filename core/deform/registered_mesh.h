// RegisteredMesh: a planar mesh, validated, with both step matrices factored [II09 §6
// "registration"].
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/result.h"
#include "core/energy/options.h"
#include "core/mesh/mesh.h"
#include "core/mesh/validation.h"

namespace arap {

class RegisteredMeshParts;

// Facts about a registered mesh, for people and for GetMesh.
struct RegistrationReport {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t edges = 0;
  std::size_t components = 0;  // connected through vertices; unreferenced vertices are none
  std::size_t boundary_loops = 0;
  double area = 0;      // squared units of the mesh
  double diagonal = 0;  // of the bounding box of the referenced vertices, units of the mesh
  std::size_t clamped_weights = 0;  // edges whose cotangent weight was raised to kMinCotangent
  std::vector<Warning> warnings;
  std::size_t bytes = 0;  // held by factors and tables
};

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
