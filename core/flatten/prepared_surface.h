// PreparedSurface: a surface validated, cut and split into charts, ready to be flattened again and
// again.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/core/flattener.h"
#include "core/cut/cut_surface.h"
#include "core/flatten/layout/factor_cache.h"
#include "core/flatten/surface_chart.h"

namespace arap {

// Immutable but for the factors that it keeps; thread-safe. What is kept: the charts, the
// elimination orders, and the factors of the last few kinds of flattening. The same method, edge
// weights and anchors ask for no factorisation, whatever is pinned where and how firmly; nor do
// layouts without pins after layouts with them. Other edge weights are other matrices: factored
// once, in the order that is there. More than kDirectPins pins on a chart are factored in, and
// factors with rigidity are not kept. The answer is the same to the last bit as without any of
// this.
class PreparedSurface {
 public:
  PreparedSurface(CutSurface surface, std::size_t input_vertices, std::size_t kept_factors);

  const CutSurface& surface() const { return surface_; }
  std::size_t input_vertices() const { return input_vertices_; }
  const std::vector<SurfaceChart>& charts() const { return charts_; }
  FactorCache& factors() const { return factors_; }
  // Grows as factors are kept.
  std::size_t bytes() const;

 private:
  CutSurface surface_;
  std::size_t input_vertices_;
  std::vector<SurfaceChart> charts_;
  mutable FactorCache factors_;
};

// Factors kept by Prepare, of each step and chart.
inline constexpr std::size_t kKeptFactors = 8;
// Of each step in all: a surface of many more charts is flattened anew each time.
inline constexpr std::size_t kMaxKeptFactors = 1024;

// Faults: those of CutToCharts.
Result<std::shared_ptr<const PreparedSurface>> Prepare(SurfaceMesh mesh, const CutOptions& options,
                                                       const CancelToken& cancel = {});

// As Flatten in flattener.h, with `options.cut` already done.
Result<Flattening> Flatten(const PreparedSurface& surface, const FlattenOptions& options,
                           const CancelToken& cancel = {});

}  // namespace arap
