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
  // stays. With a shape `from`, `force` is what pulls at it, and `image` comes as 0 and leaves with
  // the move from there. kNumerical when memory runs out.
  virtual Status Solve(std::span<double> force, std::span<const double> from,
                       std::span<double> image, Workspace& workspace) const = 0;
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
  // A preconditioned descent. Only for cells that measure the edges they fit (FACE).
  bool accelerate = false;
  // It ends when two iterations in a row lower the energy by less than this part of it; 0: when
  // nothing lowers it any more.
  double stop = 0;
};

struct LocalGlobalResult {
  int taken = 0;           // iterations
  bool converged = false;  // a descent that ended before it had to
};

// Moves `shape` (#V, units of the chart) with a solver for the same cells and held vertices.
//
// The plain iteration is a step along −L⁻¹∇E/2 of length 1 [Liu et al. 2008]. Accelerated, the same
// direction is made conjugate to the last one, in the inner product of L, and the step is Newton's
// along it [Dai and Yuan 2001]; no step raises the energy: where it would, the plain one is taken,
// which cannot. Costs two back-substitutions and two passes over the cells for each iteration.
// Faults: kNumerical, and what `cancel` answers between iterations.
Result<LocalGlobalResult> LocalGlobal(const Cells& cells, const Held& held,
                                      const RigidSolver& solver, const LocalGlobalOptions& options,
                                      const CancelToken& cancel, std::vector<Complex>& shape);

}  // namespace arap
