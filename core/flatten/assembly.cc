#include "core/flatten/assembly.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "arap/core/flattener.h"
#include "core/base/try.h"
#include "core/energy/cells.h"
#include "core/flatten/distortion.h"
#include "core/flatten/sheet/overlap.h"
#include "core/flatten/sheet/pack.h"

namespace arap {

Assembly::Assembly(const CutSurface& cut, const std::vector<Chart>& charts)
    : cut_(cut), charts_(charts), chart_of_(cut.source.size(), kNone) {
  flat_.uv.resize(cut.source.size());
  flat_.first_step.resize(cut.source.size());
  flat_.source = cut.source;
  flat_.triangle_chart.resize(cut.mesh.triangles.size());
}

void Assembly::Add(const Chart& chart, ChartLayout layout) {
  const auto index = static_cast<std::uint32_t>(flat_.charts.size());
  for (std::size_t v = 0; v < chart.vertices.size(); ++v) {
    flat_.uv[chart.vertices[v]] = layout.uv[v];
    flat_.first_step[chart.vertices[v]] = layout.first_step[v];
    chart_of_[chart.vertices[v]] = index;
  }
  for (const std::uint32_t t : chart.triangles) flat_.triangle_chart[t] = index;
  FlatChart& made = flat_.charts.emplace_back();
  for (const auto& loop : chart.loops) {
    auto& named = made.loops.emplace_back();
    for (const std::uint32_t v : loop) named.push_back(chart.vertices[v]);
  }
  for (const std::uint32_t v : layout.anchors) made.anchors.push_back(chart.vertices[v]);
  made.triangles = chart.triangles.size();
  made.refinements = layout.refinements;
  clamped_ += layout.clamped;
  flat_.times.order += layout.factor_times.analysis;
  flat_.times.factor += layout.factor_times.numbers;
}

Result<Flattening> Assembly::Finish(std::span<const Wishes> wishes, const FlattenOptions& options,
                                    const CancelToken& cancel) {
  if (charts_.size() > 1 || options.energy.basis != Basis::kEdgeAsPublished) {
    PlaceCharts(wishes, chart_of_, flat_.uv, flat_.first_step);
  }
  if (options.injective) CHECK_OK(CheckUpright());
  Corners();
  CHECK_OK(cancel.Check());
  Measure();
  if (!std::isfinite(flat_.distortion.arap_energy)) {
    return Fail(FaultKind::kNumerical, "The distortion of the flat shape is not finite.");
  }
  CHECK_OK(FindOverlaps(cancel));
  flat_.cuts = cut_.cuts;
  flat_.auto_cuts = cut_.auto_cuts;
  flat_.degenerate = cut_.degenerate;
  flat_.warnings = cut_.warnings;
  if (clamped_ > 0) flat_.warnings.push_back(ClampedWarning(clamped_));
  return std::move(flat_);
}

// Checked once more where the charts ended up, because moving them has rounded their coordinates.
Status Assembly::CheckUpright() const {
  std::vector<bool> left_out(flat_.triangle_chart.size());
  for (const std::uint32_t t : cut_.degenerate) left_out[t] = true;
  const auto flipped = NotUpright(cut_.mesh.triangles, flat_.uv, left_out);
  if (flipped.empty()) return {};
  return Fail(Fault(FaultKind::kNotInjective,
                    fmt::format("{} triangles collapse when the layout is put into its place.",
                                flipped.size()))
                  .Field("injective")
                  .Elements(flipped)
                  .Detail("flipped", flipped.size()));
}

void Assembly::Corners() {
  for (std::size_t t = 0; t < cut_.mesh.triangles.size(); ++t) {
    auto corners = cut_.mesh.triangles[t];
    if (cut_.turned[t]) std::swap(corners[1], corners[2]);
    flat_.corner_uv.push_back(corners);
  }
}

void Assembly::Measure() {
  flat_.singular_values.resize(flat_.triangle_chart.size());
  DistortionSum whole;
  for (std::size_t c = 0; c < flat_.charts.size(); ++c) {
    const Chart& chart = charts_[c];
    DistortionSum own;
    for (std::size_t t = 0; t < chart.triangles.size(); ++t) {
      const std::uint32_t id = chart.triangles[t];
      if (!chart.left_out.empty() && chart.left_out[t]) continue;
      std::array<Complex, 3> image;
      const Complex corner = flat_.uv[chart.vertices[chart.mesh.triangles[t][0]]];
      for (std::size_t k = 0; k < 3; ++k) {
        const Complex p = flat_.uv[chart.vertices[chart.mesh.triangles[t][k]]];
        image[k] = (p - corner) / chart.diagonal;
      }
      const double unit = chart.diagonal * chart.diagonal;
      const TriangleDistortion measured = MeasureTriangle(chart.frames[t], image);
      own.Add(measured, unit, id);
      whole.Add(measured, unit, id);
      flat_.singular_values[id] = measured.singular_values;
    }
    flat_.charts[c].distortion = own.Mean();
  }
  flat_.distortion = whole.Mean();
}

Status Assembly::FindOverlaps(const CancelToken& cancel) {
  std::vector<BoundaryLoop> all;
  for (std::size_t c = 0; c < flat_.charts.size(); ++c) {
    CHECK_OK(cancel.Check());
    std::vector<BoundaryLoop> own;
    for (const auto& loop : flat_.charts[c].loops) {
      own.push_back({static_cast<std::uint32_t>(c), 0, loop});
    }
    TRY(const Overlap overlap, FindOverlap(flat_.uv, own, cancel));
    flat_.charts[c].crossings = std::min(overlap.crossings, kMaxReportedCrossings);
    all.insert(all.end(), own.begin(), own.end());
  }
  TRY(const Overlap overlap, FindOverlap(flat_.uv, all, cancel));
  flat_.overlaps = overlap.any();
  return {};
}

}  // namespace arap
