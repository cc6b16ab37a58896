// What a PreparedSurface keeps.
#pragma once

#include <cstddef>
#include <vector>

#include "arap/core/flattener.h"
#include "core/cut/cut_surface.h"
#include "core/flatten/layout/factor_cache.h"
#include "core/flatten/surface_chart.h"

namespace arap {

// Factors kept by Prepare, of each step and chart.
inline constexpr std::size_t kKeptFactors = 8;
// Of each step in all: a surface of many more charts is flattened anew each time.
inline constexpr std::size_t kMaxKeptFactors = 1024;

struct PreparedSurfaceParts {
  // Keeps no more than `kept_factors` of each step and chart.
  PreparedSurfaceParts(CutSurface cut, std::size_t vertices, std::size_t kept_factors);

  CutSurface surface;  // without positions and topology: the charts have them
  std::size_t input_vertices;
  std::vector<SurfaceChart> charts;
  mutable FactorCache factors;
};

}  // namespace arap
