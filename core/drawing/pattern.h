// A flat surface as a drawing at true size, whatever file it goes to.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/model/flatten.h"
#include "core/drawing/outline.h"

namespace arap {

// Millimetres, y up.
struct Pattern {
  std::vector<Complex> points;                         // #U, the flat positions
  std::vector<Triangle> triangles;                     // #F, into points
  std::vector<std::array<double, 2>> singular_values;  // #F, or empty
  std::vector<std::vector<std::uint32_t>> outlines;    // closed, the surface on the left
  std::vector<std::vector<std::uint32_t>> seams;       // parts of the outlines that were cut open
  std::vector<std::array<Complex, 2>> grain_lines;     // both ends
  std::vector<Ring> allowance;  // what to cut out, when there is an allowance
};

struct PatternOptions {
  double millimetres_per_unit = 1;
  double allowance = 0;                    // millimetres, 0: none
  std::span<const GrainLine> grain_lines;  // those that the surface was flattened with
};

// With an allowance, charts that would come too close are set out in rows; kInvalidOption when an
// outline crosses itself too often to have one.
Result<Pattern> MakePattern(const Flattening& flat, const PatternOptions& options);

}  // namespace arap
