// The layouts that are finished: refined until they have converged, and without flips, on surfaces that are hard to lay flat.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "arap/model/mesh.h"

namespace arap::bench {

// Durations in milliseconds, the median of a few rounds that take turns.
//   refine20_ms                      two steps and 20 refinements
//   converged_ms, converged_over_20  the default, and how many times as long it takes
//   energy_over_best                 its ARAP energy over that of refining until nothing lowers it
//   best_ms                          how long that takes
//   injective_ms, symmetric_dirichlet, flipped_before
//                                    the default without flips; how many triangles it had to turn over
// What has no layout is null.
nlohmann::ordered_json MeasureLayouts(const SurfaceMesh& mesh);

// What MeasureLayouts found, a line of a table; PrintLayoutsHead begins it.
void PrintLayoutsHead();
void PrintLayouts(const std::string& name, const nlohmann::ordered_json& figures);

}  // namespace arap::bench
