// The first step of flattening: everything as similar as possible to its rest shape [II09 §7].
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "arap/base/cancel.h"
#include "core/energy/cells.h"
#include "core/flatten/chart.h"
#include "core/flatten/layout/grounded_system.h"
#include "core/flatten/layout/held.h"

namespace arap {

// Where the elimination order of a similarity matrix comes from. Its pattern depends on the
// triangles and the basis alone, not on weights or on what is held.
using OrderSource = std::function<Result<Order>(const Eigen::SparseMatrix<Complex>&)>;
Result<Order> NewOrder(const Eigen::SparseMatrix<Complex>& lower);

// The similarity matrix of `cells` with `held` (at least two) kept, factored. `assembled` is called when
// the cells have been read, which may be let go then: the factor takes the most memory of all. Fault:
// kNumerical.
Result<GroundedSystem<Complex>> HeldSystem(const Cells& cells, const Held& held,
                                           std::size_t vertices,
                                           const OrderSource& order = NewOrder,
                                           const std::function<void()>& assembled = {});

// Least similarity energy with `held` at their places: #V, units of the chart. Fault: kNumerical.
Result<std::vector<Complex>> HeldFirstStep(const GroundedSystem<Complex>& system, const Held& held,
                                           std::size_t vertices);

// The matrix with nothing kept, but raised a little, factored. Fault: kNumerical.
Result<GroundedSystem<Complex>> SpectralSystem(const Cells& cells, std::size_t vertices,
                                               const OrderSource& order = NewOrder,
                                               const std::function<void()>& assembled = {});

// Least similarity energy for a given spread of the boundary, by inverse iteration; then scaled to
// the true area and laid with the centre edge `anchors` along the real axis, its first end at 0.
// Iterations end when one changes the boundary by less than `accuracy` of the distortion itself, so
// that developable surfaces come out exact.
// [Mullen et al. 2008, spectral conformal parameterization.] Faults: kNumerical, of `cancel`.
Result<std::vector<Complex>> SpectralFirstStep(const GroundedSystem<Complex>& system,
                                               const Chart& chart,
                                               const std::array<std::uint32_t, 2>& anchors,
                                               double accuracy, const CancelToken& cancel);

// Roughly the same shape from the factor that holds the two vertices `ground`, for which `held` is
// the first step: a few back-substitutions. Where two vertices hold a curved surface too loosely,
// that step folds, and this is the better start for what follows. Faults: kNumerical, of `cancel`.
Result<std::vector<Complex>> LoosenedFirstStep(const GroundedSystem<Complex>& system,
                                               const Cells& cells, const Chart& chart,
                                               const std::array<std::uint32_t, 2>& ground,
                                               std::vector<Complex> held,
                                               const CancelToken& cancel);

// The first step with pins on the factor of two other vertices: the null-space form
// [algorithm §2], for surfaces.
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
//
// The same shape as HeldFirstStep with the pins factored in, from `system`, which holds the two
// vertices of `ground` exactly: #V, units of the chart. Costs a back-substitution per pin and a few
// more, O(#V) memory. Nothing when the last correction is not below 1e-10 of the shape: two
// vertices can be too small a hold on a very distorted surface. Faults: kNumerical, of `cancel`.
Result<std::optional<std::vector<Complex>>> PinnedFirstStep(
    const GroundedSystem<Complex>& system, const std::array<std::uint32_t, 2>& ground,
    const Cells& cells, const Held& pins, std::size_t vertices, const CancelToken& cancel);

}  // namespace arap
