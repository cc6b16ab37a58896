// The rigid steps of flattening: rotations of the cells, then the best positions for them, over and
// over [II09 §7 second step; Liu et al. 2008 local/global].
#pragma once

#include <span>
#include <vector>

#include "core/base/cancel.h"
#include "core/energy/cells.h"
#include "core/flatten/held.h"

namespace arap {

struct LocalGlobalOptions {
  int iterations = 1;
  // Ends when an iteration lowers the energy by less than this part of it; 0: never.
  double stop = 0;
  // Anderson acceleration. Only for cells whose steps descend (FACE): a step that does not is taken
  // back.
  bool accelerate = false;
};

// Moves `shape` (#V, units of the chart). Vertices in `held` are kept; without any, `still` is.
// `order` is an elimination order of a pattern around this one. Returns the iterations taken.
// Faults: kNumerical, and what `cancel` answers between iterations.
Result<int> LocalGlobal(const Cells& cells, const Held& held, std::uint32_t still,
                        const LocalGlobalOptions& options, std::span<const int> order,
                        const CancelToken& cancel, std::vector<Complex>& shape);

}  // namespace arap
