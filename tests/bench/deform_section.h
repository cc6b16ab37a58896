// The deformation part of the comparison: we, the paper's scheme and CGAL on one scene.
#pragma once

#include <nlohmann/json.hpp>

#include "arap/model/energy.h"
#include "tests/bench/scene.h"

namespace arap::bench {

// Durations in microseconds (medians of processor time), sizes in bytes, "vertices" and
// "triangles". "refine1_us" is a whole update with one refinement, "paper_distance" the largest
// distance between the paper's shapes and ours for the same energy, in diagonals; "floor_us" two
// plain reads of as much memory as the factor of step 2 takes, "update_over_floor" the update over it. CGAL's entries
// are there only with CGAL.
//
// First makes sure that the paper's scheme and ours, asked for the same energy, give the same
// shapes; aborts with a message when not, because then there is nothing to compare.
nlohmann::ordered_json MeasureDeform(const Scene& scene, Basis basis);

// What MeasureDeform found, side by side on stdout.
void PrintDeform(const Scene& scene, const nlohmann::ordered_json& figures);

}  // namespace arap::bench
