// The rigid steps of flattening: rotations of the cells, then the best positions for them, over and
// over [II09 §7 second step; Liu et al. 2008 local/global].
#pragma once

#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "core/energy/cells.h"
#include "core/flatten/layout/grounded_system.h"
#include "core/flatten/layout/held.h"
#include "core/flatten/layout/rigid_solver.h"

namespace arap {

struct LocalGlobalOptions {
  int iterations = 1;
  // Anderson acceleration. Only for cells whose steps descend (FACE): a step that does not is taken
  // back.
  bool accelerate = false;
  // Accelerated iterations end when one lowers the energy by less than this part of it; 0: never.
  double stop = 0;
};

// The matrix of the rigid step, factored. Vertices in `held` are kept; without any, `still` is.
// `order` is an elimination order of a pattern around this one. Fault: kNumerical.
Result<GroundedSystem<double>> RigidSystem(const Cells& cells, const Held& held,
                                           std::uint32_t still, std::size_t vertices, Order order);

// Moves `shape` (#V, units of the chart) with a solver for the same cells and held vertices.
// Returns the iterations taken. Faults: kNumerical, and what `cancel` answers between iterations.
Result<int> LocalGlobal(const Cells& cells, const Held& held, const RigidSolver& solver,
                        const LocalGlobalOptions& options, const CancelToken& cancel,
                        std::vector<Complex>& shape);

}  // namespace arap
