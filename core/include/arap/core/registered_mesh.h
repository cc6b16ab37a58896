// RegisteredMesh: a planar mesh, validated, with both step matrices factored [II09 §6
// "registration"].
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/energy.h"
#include "arap/model/mesh.h"
#include "arap/model/repair.h"

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
  // The same for a mesh that is mended first. What was asked for and what could be asked for are
  // warnings of report(). Vertices keep their numbers: those that were welded have one place at rest,
  // that of the lowest, and in every shape, and a handle may be on any of them. Triangles are those that
  // were given too, for anchors, rigidity, flipped triangles, picks and the drawing order; mesh() has the
  // triangles that are computed with, and ShapeQuality counts those.
  //
  // More faults: kInvalidOption (fields "repair.tolerance", "repair.stitch").
  static Result<std::shared_ptr<const RegisteredMesh>> Register(PlanarMesh mesh,
                                                                const EnergyOptions& options,
                                                                const RepairOptions& repairs,
                                                                const MeshLimits& limits = {},
                                                                const CancelToken& cancel = {});
  // What Register says of the options of a mesh with so many triangles, for who takes memory first:
  // kArrayLength and kInvalidOption for the rigidity.
  static Status CheckOptions(const EnergyOptions& options, std::size_t triangles);
  ~RegisteredMesh();
  RegisteredMesh(const RegisteredMesh&) = delete;
  RegisteredMesh& operator=(const RegisteredMesh&) = delete;

  // The mesh as registered: mended where that was asked for, triangles turned counter-clockwise,
  // positions as they were given.
  const PlanarMesh& mesh() const;
  const EnergyOptions& options() const;
  const RepairOptions& repairs() const;
  // The vertices of edges with one triangle, ascending; of welded ones the lowest. O(#V + #E).
  std::vector<std::uint32_t> BoundaryVertices() const;
  // Counts, measures, warnings, and the bytes that the factors and tables hold.
  const RegistrationReport& report() const;

  // For the rest of the core.
  const RegisteredMeshParts& parts() const { return *parts_; }

 private:
  static Result<std::shared_ptr<const RegisteredMesh>> Make(PlanarMesh mesh,
                                                            const EnergyOptions& options,
                                                            const RepairOptions& repairs,
                                                            const MeshLimits& limits,
                                                            const CancelToken& cancel);
  explicit RegisteredMesh(std::unique_ptr<const RegisteredMeshParts> parts);
  std::unique_ptr<const RegisteredMeshParts> parts_;
};

}  // namespace arap
