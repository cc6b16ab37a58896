// A flat surface as a drawing at true size, whatever file it goes to.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "arap/client/flatten.h"
#include "core/drawing/allowance.h"

namespace arap::cli {

// Millimetres, y up.
struct Pattern {
  std::vector<double> points;                        // x y x y…, the flat positions
  std::vector<std::uint32_t> triangles;              // into points, length 3·#F
  std::vector<double> singular_values;               // s1 s2 per triangle, or empty
  std::vector<std::vector<std::uint32_t>> outlines;  // closed, the surface on the left
  std::vector<std::vector<std::uint32_t>> seams;     // parts of the outlines that were cut open
  std::vector<std::array<double, 4>> grain_lines;    // x y of both ends
  std::vector<Ring> allowance;                       // what to cut out, when there is an allowance
};

struct PatternOptions {
  double millimetres_per_unit = 1;
  double allowance = 0;                            // millimetres, 0: none
  std::span<const client::GrainLine> grain_lines;  // those that the surface was flattened with
};

// With an allowance, charts that would come too close are set out in rows.
Pattern MakePattern(const client::FlatSurface& flat, const PatternOptions& options);

}  // namespace arap::cli
