// The flattening part of the comparison: we and CGAL's parameterizers on one surface.
#pragma once

#include <nlohmann/json.hpp>

#include "arap/model/mesh.h"

namespace arap::bench {

// Durations in milliseconds (medians of processor time), memory in bytes: the growth of a process
// of its own while it works.
//   topology_ms, order_ms, factor_ms, solve_ms, total_ms   LSCM between the ends of the centre edge
//   refine20_ms (and refine20_… as above)   two steps and 20 refinements, our default anchors
//   arap_energy, flipped                    of the latter
//   peak_bytes                              the larger of both
//   cgal_lscm_…, cgal_arap_…                the same of CGAL, there only with CGAL
// "…_scaled_energy" is the ARAP energy at the best size. What takes a contender more than `budget`
// seconds is null.
nlohmann::ordered_json MeasureFlatten(const SurfaceMesh& mesh, double budget);

// What MeasureFlatten found, side by side on stdout.
void PrintFlatten(const nlohmann::ordered_json& figures, double budget);

}  // namespace arap::bench
