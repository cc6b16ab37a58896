// Several layouts of one surface side by side.
#pragma once

#include <string>
#include <vector>

#include "arap/model/flatten.h"

namespace arap {

struct ComparisonPanel {
  std::string label;
  Flattening flat;                 // with singular values
  std::vector<std::string> lines;  // beneath the picture
};

// For each panel the surface from in front with a checkerboard that the layout maps onto it, and
// the layout at the scale of the surface, turned to the same side and coloured by strain; one scale
// and one legend for all. A panel without flat positions shows its lines alone.
std::string FormatComparison(const SurfaceMesh& mesh, const std::vector<ComparisonPanel>& panels,
                             const std::string& caption);

}  // namespace arap
