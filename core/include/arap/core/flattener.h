// Flattening: a surface cut into charts, every chart laid in the plane, as rigidly as possible
// [II09 §7].
#pragma once

#include <cstddef>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/flatten.h"

namespace arap {

// Above this many pins on a chart kAuto factors them in: each costs two back-substitutions, and a
// number per vertex and iteration.
inline constexpr std::size_t kDirectPins = 32;

// Crossings of a chart's boundary are counted up to this.
inline constexpr std::size_t kMaxReportedCrossings = 1000;

// Stateless, thread-safe. Faults: those of CutToCharts and CheckEnergyOptions, kInvalidOption (pins
// and grain lines by their field), kNotInjective, kNumerical, and whatever `cancel` answers between
// the phases and in the long loops. Unreferenced vertices get the uv (0, 0) and a warning.
Result<Flattening> Flatten(SurfaceMesh mesh, const FlattenOptions& options,
                           const CancelToken& cancel = {});

}  // namespace arap
