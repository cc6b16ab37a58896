// What flatten says about its results.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "arap/client/flatten.h"
#include "core/drawing/comparison.h"
#include "core/drawing/pattern.h"

namespace arap::cli {

// A JSON object: counts, every measure of distortion of the whole and of each chart, the sizes of
// pieces and sheet in millimetres as `pattern` has them, anchors, cuts, warnings and times; with
// `sigma` also "singular_values", [s1, s2] of every triangle, s2 negative where it is flipped,
// [0, 0] where it was left out. Indices count from 0.
nlohmann::ordered_json ReportJson(const SurfaceMesh& mesh, const client::FlatSurface& flat,
                                  const Pattern& pattern, bool sigma = false);
// The same for each panel: its "label" with its "distortion", or with the "error" why there is
// none.
nlohmann::ordered_json ComparisonJson(const std::vector<ComparisonPanel>& panels);
// A line for people with the measures of each panel.
std::string FormatTable(const std::vector<ComparisonPanel>& panels);

}  // namespace arap::cli
