// CGAL's Surface_mesh_deformation on a planar mesh (z = 0), for comparison. Optional: without CGAL
// nothing can be made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "arap/model/mesh.h"

namespace arap::bench {

// With CGAL's own defaults: sparse LU, polar rotations with an SVD to fall back on, cotangent
// weights. Not thread-safe.
class CgalScheme {
 public:
  // Null when there is no CGAL. All vertices may move.
  static std::unique_ptr<CgalScheme> Make(const PlanarMesh& mesh);
  static bool Available() { return !Version().empty(); }
  static std::string Version();  // empty when there is no CGAL
  virtual ~CgalScheme() = default;

  // Takes other vertices as handles; cheap.
  virtual void SetHandles(std::span<const std::uint32_t> vertices) = 0;
  // preprocess(): assembles and factors. Aborts when it fails.
  virtual void Preprocess() = 0;
  // One iteration: one solve and one step of rotations, going on from the last shape. One target
  // per handle. CGAL moves its own mesh.
  virtual void Iterate(std::span<const Complex> targets) = 0;
  virtual Complex Position(std::uint32_t vertex) const = 0;
};

}  // namespace arap::bench
