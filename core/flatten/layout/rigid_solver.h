// RigidSolver: the best positions for given rotations, with vertices held.
//
// Two ways lead to the same positions: the held vertices factored in, or the null-space form
// [algorithm §4] on a factor that holds one vertex and serves whatever is pinned.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "core/flatten/layout/grounded_system.h"
#include "core/flatten/layout/held.h"

namespace arap {

// Immutable; thread-safe with a Workspace per thread. Points are x…, then y…: 2·#V numbers.
class RigidSolver {
 public:
  virtual ~RigidSolver() = default;

  // `force` comes with the edges' share and is scratch. `image` comes with any shape and leaves
  // with the best positions; hard pins are met exactly. Where nothing is held, the grounded vertex
  // stays. kNumerical when memory runs out.
  virtual Status Solve(std::span<double> force, std::span<double> image,
                       Workspace& workspace) const = 0;
};

using RigidFactor = std::shared_ptr<const GroundedSystem<double>>;

// `factor` has `held` in it.
std::unique_ptr<const RigidSolver> FactoredRigidSolver(RigidFactor factor, Held held);

// `factor` holds the vertex `ground` and nothing else. A back-substitution per pin, and #V numbers
// each. Faults: kNumerical, of `cancel`.
Result<std::unique_ptr<const RigidSolver>> PinnedRigidSolver(RigidFactor factor,
                                                             std::uint32_t ground, Held pins,
                                                             const CancelToken& cancel);

}  // namespace arap
