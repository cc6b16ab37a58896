// The first step of flattening: everything as similar as possible to its rest shape [II09 §7].
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "arap/base/cancel.h"
#include "core/flatten/layout/grounded_system.h"
#include "core/flatten/layout/held.h"
#include "core/flatten/surface_chart.h"

namespace arap {

// Where the elimination order of a similarity matrix comes from. Its pattern depends on the
// triangles and the basis alone, not on weights or on what is held.
using OrderSource = std::function<Result<Order>(const Eigen::SparseMatrix<Complex>&)>;
Result<Order> NewOrder(const Eigen::SparseMatrix<Complex>& lower);

// The similarity matrix of `cells` with `held` (at least two) kept, factored. Fault: kNumerical.
Result<GroundedSystem<Complex>> HeldSystem(const Cells& cells, const Held& held,
                                           std::size_t vertices,
                                           const OrderSource& order = NewOrder);

// Least similarity energy with `held` at their places: #V, units of the chart. Fault: kNumerical.
Result<std::vector<Complex>> HeldFirstStep(const GroundedSystem<Complex>& system, const Held& held,
                                           std::size_t vertices);

// The matrix with nothing kept, but raised a little, factored. Fault: kNumerical.
Result<GroundedSystem<Complex>> SpectralSystem(const Cells& cells, std::size_t vertices,
                                               const OrderSource& order = NewOrder);

// Least similarity energy for a given spread of the boundary, by inverse iteration; then scaled to
// the true area and laid with the centre edge `anchors` along the real axis, its first end at 0.
// Iterations end when one changes the boundary by less than `accuracy` of the distortion itself, so
// that developable surfaces come out exact.
// [Mullen et al. 2008, spectral conformal parameterization.] Faults: kNumerical, of `cancel`.
Result<std::vector<Complex>> SpectralFirstStep(const GroundedSystem<Complex>& system,
                                               const SurfaceChart& chart,
                                               const std::array<std::uint32_t, 2>& anchors,
                                               double accuracy, const CancelToken& cancel);

}  // namespace arap
