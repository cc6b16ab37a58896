#include "arap/core/flattener.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/timer.h"
#include "core/base/try.h"
#include "core/energy/build_cells.h"
#include "core/flatten/distortion.h"
#include "core/flatten/flatten_chart.h"
#include "core/flatten/layout/pins.h"
#include "core/flatten/prepared_surface.h"
#include "core/flatten/sheet/overlap.h"
#include "core/flatten/sheet/placement.h"
#include "core/flatten/sheet/upright.h"

namespace arap {
namespace {

Status CheckOptions(const FlattenOptions& options, std::size_t triangles) {
  if (options.refine < 0 || options.refine > kMaxFlattenRefine) {
    return Fail(Fault(FaultKind::kInvalidOption, fmt::format("refine is {}; it must be 0 to {}",
                                                             options.refine, kMaxFlattenRefine))
                    .Field("refine")
                    .Detail("limit", fmt::to_string(kMaxFlattenRefine)));
  }
  if (!(options.refine_stop >= 0 && options.refine_stop <= 1)) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("refine_stop is {}; it must be 0 to 1", options.refine_stop))
                    .Field("refine_stop")
                    .Detail("limit", "1"));
  }
  return CheckEnergyOptions(options.energy, triangles);
}

EnergyOptions EnergyOf(const SurfaceChart& chart, const EnergyOptions& energy) {
  EnergyOptions own{energy.basis, energy.weights, {}};
  if (energy.rigidity.empty()) return own;
  for (const std::uint32_t t : chart.triangles) own.rigidity.push_back(energy.rigidity[t]);
  return own;
}

// The answer while it is put together from the charts.
class Assembly {
 public:
  explicit Assembly(const PreparedSurfaceParts& surface) : surface_(surface) {
    const CutSurface& cut = surface.surface;
    flat_.uv.resize(cut.source.size());
    flat_.first_step.resize(cut.source.size());
    flat_.source = cut.source;
    flat_.triangle_chart.resize(cut.mesh.triangles.size());
    chart_of_.assign(cut.source.size(), kNone);
  }

  void Add(const SurfaceChart& chart, ChartLayout layout) {
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

  Result<Flattening> Finish(std::span<const ChartWishes> wishes, bool injective,
                            const CancelToken& cancel) {
    PlaceCharts(wishes, chart_of_, flat_.uv, flat_.first_step);
    if (injective) {
      if (auto ok = CheckUpright(); !ok) return Fail(std::move(ok.error()));
    }
    Corners();
    if (auto ok = cancel.Check(); !ok) return Fail(std::move(ok.error()));
    Measure();
    if (!std::isfinite(flat_.distortion.arap_energy)) {
      return Fail(FaultKind::kNumerical, "the distortion of the flat shape is not finite");
    }
    if (auto ok = FindOverlaps(cancel); !ok) return Fail(std::move(ok.error()));
    const CutSurface& cut = surface_.surface;
    flat_.cuts = cut.cuts;
    flat_.auto_cuts = cut.auto_cuts;
    flat_.degenerate = cut.degenerate;
    flat_.warnings = cut.warnings;
    if (clamped_ > 0) flat_.warnings.push_back(ClampedWarning(clamped_));
    return std::move(flat_);
  }

 private:
  // Once more where the charts ended up: their new coordinates are rounded anew.
  Status CheckUpright() const {
    std::vector<bool> left_out(flat_.triangle_chart.size());
    for (const std::uint32_t t : surface_.surface.degenerate) left_out[t] = true;
    const auto flipped = NotUpright(surface_.surface.mesh.triangles, flat_.uv, left_out);
    if (flipped.empty()) return {};
    Fault fault = Fault(FaultKind::kNotInjective,
                        fmt::format("{} triangles collapse when the layout is put into its place",
                                    flipped.size()))
                      .Field("injective");
    for (const std::uint32_t t : flipped) fault.Element(t);
    return Fail(std::move(fault));
  }

  void Corners() {
    const CutSurface& cut = surface_.surface;
    for (std::size_t t = 0; t < cut.mesh.triangles.size(); ++t) {
      auto corners = cut.mesh.triangles[t];
      if (cut.turned[t]) std::swap(corners[1], corners[2]);
      flat_.corner_uv.push_back(corners);
    }
  }

  void Measure() {
    flat_.singular_values.resize(flat_.triangle_chart.size());
    DistortionSum whole;
    for (std::size_t c = 0; c < flat_.charts.size(); ++c) {
      const SurfaceChart& chart = surface_.charts[c];
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

  Status FindOverlaps(const CancelToken& cancel) {
    std::vector<BoundaryLoop> all;
    for (std::size_t c = 0; c < flat_.charts.size(); ++c) {
      std::vector<BoundaryLoop> own;
      for (const auto& loop : flat_.charts[c].loops) {
        own.push_back({static_cast<std::uint32_t>(c), 0, loop});
      }
      const auto overlap = FindOverlap(flat_.uv, own, cancel);
      if (!overlap) return Fail(overlap.error());
      flat_.charts[c].crossings = std::min<std::size_t>(overlap->crossings, kMaxReportedCrossings);
      all.insert(all.end(), own.begin(), own.end());
    }
    const auto overlap = FindOverlap(flat_.uv, all, cancel);
    if (!overlap) return Fail(overlap.error());
    flat_.overlaps = overlap->any();
    return {};
  }

  const PreparedSurfaceParts& surface_;
  Flattening flat_;
  std::vector<std::uint32_t> chart_of_;  // #U
  std::size_t clamped_ = 0;
};

// Without the time that preparing took.
Result<Flattening> FlattenPrepared(const PreparedSurfaceParts& surface,
                                   const FlattenOptions& options, const CancelToken& cancel,
                                   PinSolver solver) {
  Stopwatch watch;
  CHECK_OK(CheckOptions(options, surface.surface.mesh.triangles.size()));
  TRY(const auto wishes, FindWishes(surface, options, cancel));
  Assembly assembly(surface);
  for (std::size_t c = 0; c < surface.charts.size(); ++c) {
    CHECK_OK(cancel.Check());
    const SurfaceChart& chart = surface.charts[c];
    TRY(auto layout, FlattenChart(chart, options, EnergyOf(chart, options.energy), solver,
                                  wishes[c], fmt::to_string(c), surface.factors, cancel));
    assembly.Add(chart, std::move(layout));
  }
  TRY(auto flat, assembly.Finish(wishes, options.injective, cancel));
  flat.times.solve = watch.Lap() - flat.times.order - flat.times.factor;
  return flat;
}

}  // namespace

Result<Flattening> Flatten(const PreparedSurface& surface, const FlattenOptions& options,
                           const CancelToken& cancel, PinSolver solver) {
  return FlattenPrepared(surface.parts(), options, cancel, solver);
}

Result<Flattening> Flatten(SurfaceMesh mesh, const FlattenOptions& options,
                           const MeshLimits& limits, const CancelToken& cancel, PinSolver solver) {
  CHECK_OK(CheckOptions(options, mesh.triangles.size()));
  Stopwatch watch;
  const std::size_t vertices = mesh.vertices.size();
  TRY(auto surface, CutToCharts(std::move(mesh), options.cut, limits, cancel));
  // Nobody asks again: the factors go as soon as they were used.
  const PreparedSurfaceParts prepared(std::move(surface), vertices, 0);
  const double topology = watch.Lap();
  TRY(auto flat, FlattenPrepared(prepared, options, cancel, solver));
  flat.times.topology = topology;
  return flat;
}

}  // namespace arap
