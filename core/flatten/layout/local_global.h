// The rigid steps of flattening: rotations of the cells, then the best positions for them, over and
// over [II09 §7 second step; Liu et al. 2008 local/global].
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "core/energy/cells.h"
#include "core/flatten/layout/grounded_system.h"
#include "core/flatten/layout/held.h"

namespace arap {

// The matrix of the rigid step, factored. Vertices in `held` are kept; without any, `still` is.
// `order` is an elimination order of a pattern around this one. Fault: kNumerical.
Result<GroundedSystem<double>> RigidSystem(const Cells& cells, const Held& held,
                                           std::uint32_t still, std::size_t vertices, Order order);

// The best positions for given rotations, with vertices held. Two ways lead to the same: the held
// vertices factored in, or the null-space form [algorithm §2] on a factor that holds one vertex and
// serves whatever is pinned. Immutable; thread-safe with a Workspace per thread. Points are x…,
// then y…: 2·#V numbers.
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

struct LocalGlobalOptions {
  int iterations = 1;
  // Anderson acceleration. Only for cells whose steps descend (FACE): a step that does not is taken
  // back.
  bool accelerate = false;
  // Accelerated iterations end when one lowers the energy by less than this part of it; 0: never.
  double stop = 0;
};

// Moves `shape` (#V, units of the chart) with a solver for the same cells and held vertices.
// Returns the iterations taken. Faults: kNumerical, and what `cancel` answers between iterations.
Result<int> LocalGlobal(const Cells& cells, const Held& held, const RigidSolver& solver,
                        const LocalGlobalOptions& options, const CancelToken& cancel,
                        std::vector<Complex>& shape);

}  // namespace arap
