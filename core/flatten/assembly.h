// Assembly: a flattening put together from the charts that were laid flat, and made one of the
// surface as it was given where that was mended first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "arap/base/cancel.h"
#include "arap/base/result.h"
#include "arap/model/flatten.h"
#include "core/cut/cut_surface.h"
#include "core/flatten/chart.h"
#include "core/flatten/chart_layout.h"
#include "core/flatten/layout/wishes.h"
#include "core/mesh/repair.h"

namespace arap {

// One flattening: Add for every chart of the surface in order, then Finish.
class Assembly {
 public:
  // Refers to both. `charts` are those of `cut`, whose mesh they have taken.
  Assembly(const CutSurface& cut, const std::vector<Chart>& charts);

  void Add(const Chart& chart, ChartLayout layout);

  // Places the charts side by side, then measures them and looks for overlaps. A single chart of
  // kEdgeAsPublished stays as published, its first anchor at 0 and the other on the u axis. Faults:
  // kNotInjective (when that is asked for and the last rounding collapses a triangle), kNumerical,
  // of `cancel`.
  Result<Flattening> Finish(std::span<const Wishes> wishes, const FlattenOptions& options,
                            const CancelToken& cancel);

 private:
  Status CheckUpright() const;
  void Corners();
  void Turn();
  void Measure();
  Status FindOverlaps(const CancelToken& cancel);

  const CutSurface& cut_;
  const std::vector<Chart>& charts_;
  Flattening flat_;
  std::vector<std::uint32_t> chart_of_;  // #U
  std::size_t clamped_ = 0;              // edges whose cotangent was raised
};

// Options whose pins and grain lines name vertices that stand for themselves, and whose rigidity is that
// of the mended triangles. Seams are the cutter's to translate. `repair` has changed something.
FlattenOptions OfMended(FlattenOptions options, const Repair& repair);

// A layout of the mended surface made one of the given vertices and triangles:
//   corners of a triangle have the positions of its parts, or of the one that was kept in its place;
//   singular values are those of its worst part; a chart counts the given triangles that are on it;
//   what collapsed counts as left out, on the chart of its corner;
//   a vertex that another stands for lies where its lowest triangle has it; `welded` says which.
// "torn_triangles" warns of given triangles whose parts were cut apart: their corners name one side.
// O(#V + #F log #F).
void OfGiven(const Repair& repair, Flattening& flat);

}  // namespace arap
