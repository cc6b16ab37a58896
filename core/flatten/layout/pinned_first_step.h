// The first step with pins, on the factor of two other vertices: the null-space form
// [algorithm §4], for surfaces.
//
// With G the solve that grounds two vertices, the shape of least energy for given pins is
//
//     x = Z λ + N β,   Z = G Cᴴ
//     [ C Z + E    C N ] [λ]   [ c ]
//     [ (C N)ᴴ      −S ] [β] = [ 0 ]
//
// where C picks the pinned vertices, E is their compliance, and N has the constants and the shape
// that G's own vertices hold. On a curved surface that shape has energy, which is S; only where
// the surface is developable S is 0 and N the null space.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "arap/base/cancel.h"
#include "core/energy/cells.h"
#include "core/flatten/layout/grounded_system.h"
#include "core/flatten/layout/held.h"

namespace arap {

// The same shape as HeldFirstStep with the pins factored in, from `system`, which holds the two
// vertices of `ground` exactly: #V, units of the chart. Costs a back-substitution per pin and a few
// more, O(#V) memory. Nothing when the last correction is not below 1e-10 of the shape: two
// vertices can be too small a hold on a very distorted surface. Faults: kNumerical, of `cancel`.
Result<std::optional<std::vector<Complex>>> PinnedFirstStep(
    const GroundedSystem<Complex>& system, const std::array<std::uint32_t, 2>& ground,
    const Cells& cells, const Held& pins, std::size_t vertices, const CancelToken& cancel);

}  // namespace arap
