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

namespace arap {

struct RegisteredMeshParts;

// Immutable, safe to share between threads. Every handle set on the mesh keeps it alive and shares
// its factors.
class RegisteredMesh {
 public:
  // Validates the mesh, builds the cells of its energy and factors both steps. Clockwise triangles
  // are turned round and unreferenced vertices let through, both with a warning in report().
  // O(n^1.5) time and O(n log n) memory for n vertices; about 0.1 s at 10,000.
  //
  // Faults, with the first ids at fault in `Fault::elements`:
  //   kEmptyMesh, kMeshTooLarge (beyond `limits`), kNonFiniteCoordinate (or beyond 1e150),
  //   kIndexOutOfRange, kRepeatedIndex, kDuplicateTriangle, kNonManifoldEdge, kDegenerateTriangle;
  //   kArrayLength and kInvalidOption for the rigidity; kNumerical when a factorisation fails;
  //   kOutOfMemory; whatever `cancel` answers between the phases.
  static Result<std::shared_ptr<const RegisteredMesh>> Register(PlanarMesh mesh,
                                                                const EnergyOptions& options,
                                                                const MeshLimits& limits = {},
                                                                const CancelToken& cancel = {});
  // What Register says of the options of a mesh with so many triangles, for who takes memory first:
  // kArrayLength and kInvalidOption for the rigidity.
  static Status CheckOptions(const EnergyOptions& options, std::size_t triangles);
  ~RegisteredMesh();
  RegisteredMesh(const RegisteredMesh&) = delete;
  RegisteredMesh& operator=(const RegisteredMesh&) = delete;

  // The mesh as registered: triangles turned counter-clockwise, positions as they were given.
  const PlanarMesh& mesh() const;
  const EnergyOptions& options() const;
  // Counts, measures, warnings, and the bytes that the factors and tables hold.
  const RegistrationReport& report() const;

  // For the rest of the core.
  const RegisteredMeshParts& parts() const { return *parts_; }

 private:
  static Result<std::shared_ptr<const RegisteredMesh>> Make(PlanarMesh mesh,
                                                            const EnergyOptions& options,
                                                            const MeshLimits& limits,
                                                            const CancelToken& cancel);
  explicit RegisteredMesh(std::unique_ptr<const RegisteredMeshParts> parts);
  std::unique_ptr<const RegisteredMeshParts> parts_;
};

}  // namespace arap
