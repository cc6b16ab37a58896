// The first step of flattening: everything as similar as possible to its rest shape [II09 §7].
#pragma once

#include <memory>
#include <vector>

#include <Eigen/SparseCore>

#include "core/base/cancel.h"
#include "core/flatten/chart.h"
#include "core/flatten/held.h"

namespace arap {

// Least similarity energy with `held` (at least two) at their places: #V, units of the chart.
// `order` receives the elimination order, which fits the second step too. Fault: kNumerical.
Result<std::vector<Complex>> HeldFirstStep(const Eigen::SparseMatrix<Complex>& energy,
                                           const Held& held, std::vector<int>& order);

// Least similarity energy for a given spread of the boundary, by inverse iteration; then scaled to
// the true area and laid with the centre edge `anchors` along the real axis, its first end at 0.
// Iterations end when one changes the boundary (of unit spread) by less than `accuracy`.
// [Mullen et al. 2008, spectral conformal parameterization.] Faults: kNumerical, of `cancel`.
Result<std::vector<Complex>> SpectralFirstStep(const Chart& chart,
                                               Eigen::SparseMatrix<Complex> energy,
                                               const std::array<std::uint32_t, 2>& anchors,
                                               double accuracy, const CancelToken& cancel,
                                               std::vector<int>& order);

}  // namespace arap
