#include "core/flatten/assembly.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "arap/core/flattener.h"
#include "core/base/try.h"
#include "core/energy/cells.h"
#include "core/flatten/distortion.h"
#include "core/flatten/sheet/overlap.h"
#include "core/flatten/sheet/pack.h"
#include "core/mesh/topology.h"
#include "core/mesh/validation.h"

namespace arap {

Assembly::Assembly(const CutSurface& cut, const std::vector<Chart>& charts)
    : cut_(cut), charts_(charts) {}

void Assembly::Add(const Chart& chart, ChartLayout layout) {
  if (flat_.charts.empty()) {
    // Not before: the first chart's factors are gone by now.
    flat_.uv.resize(cut_.source.size());
    flat_.first_step.resize(cut_.source.size());
    flat_.triangle_chart.resize(cut_.turned.size());
    chart_of_.assign(cut_.source.size(), kNone);
  }
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
  made.refine_end = layout.refine_end;
  clamped_ += layout.clamped;
  flat_.times.order += layout.factor_times.analysis;
  flat_.times.factor += layout.factor_times.numbers;
}

Result<Flattening> Assembly::Finish(std::span<const Wishes> wishes, const FlattenOptions& options,
                                    const CancelToken& cancel) {
  if (charts_.size() > 1 || options.energy.basis != Basis::kEdgeAsPublished) {
    PlaceCharts(wishes, chart_of_, flat_.uv, flat_.first_step);
  }
  Corners();
  if (options.injective) CHECK_OK(CheckUpright());
  Turn();
  CHECK_OK(cancel.Check());
  Measure();
  if (!std::isfinite(flat_.distortion.arap_energy)) {
    return Fail(FaultKind::kNumerical, "The distortion of the flat shape is not finite.");
  }
  CHECK_OK(FindOverlaps(cancel));
  flat_.source = cut_.source;
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
  const auto flipped = NotUpright(flat_.corner_uv, flat_.uv, left_out);
  if (flipped.empty()) return {};
  return Fail(Fault(FaultKind::kNotInjective,
                    fmt::format("{} triangles collapse when the layout is put into its place.",
                                flipped.size()))
                  .Field("injective")
                  .Elements(flipped)
                  .Detail("flipped", flipped.size()));
}

void Assembly::Corners() {
  flat_.corner_uv.resize(cut_.turned.size());
  for (const Chart& chart : charts_) {
    for (std::size_t t = 0; t < chart.triangles.size(); ++t) {
      const Triangle& c = chart.mesh.triangles[t];
      flat_.corner_uv[chart.triangles[t]] = {chart.vertices[c[0]], chart.vertices[c[1]],
                                             chart.vertices[c[2]]};
    }
  }
}

// As the triangles were given.
void Assembly::Turn() {
  for (std::size_t t = 0; t < flat_.corner_uv.size(); ++t) {
    if (cut_.turned[t]) std::swap(flat_.corner_uv[t][1], flat_.corner_uv[t][2]);
  }
}

void Assembly::Measure() {
  flat_.singular_values.resize(flat_.triangle_chart.size());
  DistortionSum whole;
  for (std::size_t c = 0; c < flat_.charts.size(); ++c) {
    const Chart& chart = charts_[c];
    DistortionSum own;
    for (std::uint32_t t = 0; t < chart.triangles.size(); ++t) {
      const std::uint32_t id = chart.triangles[t];
      if (!chart.left_out.empty() && chart.left_out[t]) continue;
      std::array<Complex, 3> image;
      const Complex corner = flat_.uv[chart.vertices[chart.mesh.triangles[t][0]]];
      for (std::size_t k = 0; k < 3; ++k) {
        const Complex p = flat_.uv[chart.vertices[chart.mesh.triangles[t][k]]];
        image[k] = (p - corner) / chart.diagonal;
      }
      const double unit = chart.diagonal * chart.diagonal;
      const TriangleDistortion measured = MeasureTriangle(chart.Frame(t), image);
      own.Add(measured, unit, id);
      if (charts_.size() > 1) whole.Add(measured, unit, id);
      flat_.singular_values[id] = measured.singular_values;
    }
    flat_.charts[c].distortion = own.Mean();
  }
  flat_.distortion = charts_.size() > 1 ? whole.Mean() : flat_.charts[0].distortion;
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

namespace {

// max(s1, 1/|s2|), above everything for what is flipped.
double Badness(const std::array<double, 2>& values) {
  const double worst = std::max(values[0], 1 / std::max(std::abs(values[1]), 1e-300));
  return values[1] < 0 ? 1e300 + worst : worst;
}

class Translator {
 public:
  Translator(const Repair& repair, Flattening& flat) : repair_(repair), flat_(flat) {}

  void Run() {
    FindChartsOfVertices();
    corners_.resize(repair_.given.size());
    charts_.resize(repair_.given.size());
    values_.resize(repair_.given.size());
    std::vector<std::uint32_t> torn, left_out;
    for (const std::uint32_t t : flat_.degenerate) left_out.push_back(repair_.TriangleOf(t));
    for (std::uint32_t t = 0; t < repair_.given.size(); ++t) {
      const Repair::Parts parts = repair_.PartsOf(t);
      if (parts.size() == 0) {
        corners_[t] = repair_.CornersOf(t);
        charts_[t] = chart_of_[corners_[t][0]];
        left_out.push_back(t);
      } else if (TakeParts(t, parts)) {
        torn.push_back(t);
      }
    }
    std::sort(left_out.begin(), left_out.end());
    left_out.erase(std::unique(left_out.begin(), left_out.end()), left_out.end());
    flat_.degenerate = std::move(left_out);
    flat_.corner_uv = std::move(corners_);
    flat_.triangle_chart = std::move(charts_);
    flat_.singular_values = std::move(values_);
    CountTriangles();
    PlaceWelded();
    AddWarning("torn_triangles", torn,
               fmt::format("{} triangles that were split are cut apart inside; their corners have "
                           "positions of one side of the cut",
                           torn.size()),
               flat_.warnings);
  }

 private:
  // Of the vertices that stand for themselves; those of nothing that is left are put on the first.
  void FindChartsOfVertices() {
    chart_of_.assign(repair_.vertex.size(), 0);
    for (std::size_t t = flat_.corner_uv.size(); t-- > 0;) {
      for (const std::uint32_t u : flat_.corner_uv[t]) {
        if (u < chart_of_.size()) chart_of_[u] = flat_.triangle_chart[t];
      }
    }
  }

  // Whether the parts do not agree about where a corner is.
  bool TakeParts(std::uint32_t t, Repair::Parts parts) {
    const Triangle wanted = repair_.CornersOf(t);
    bool torn = false;
    Triangle& corners = corners_[t];
    corners = {kNone, kNone, kNone};
    charts_[t] = flat_.triangle_chart[parts.begin];
    values_[t] = flat_.singular_values[parts.begin];
    for (std::uint32_t part = parts.begin; part < parts.end; ++part) {
      for (const std::uint32_t u : flat_.corner_uv[part]) {
        for (std::size_t k = 0; k < 3; ++k) {
          if (flat_.source[u] != wanted[k]) continue;
          if (corners[k] == kNone) corners[k] = u;
          torn = torn || corners[k] != u;
        }
      }
      torn = torn || flat_.triangle_chart[part] != charts_[t];
      if (Badness(flat_.singular_values[part]) > Badness(values_[t])) {
        values_[t] = flat_.singular_values[part];
      }
    }
    return torn;
  }

  void CountTriangles() {
    for (FlatChart& chart : flat_.charts) {
      chart.triangles = 0;
      chart.distortion.worst_triangle = repair_.TriangleOf(chart.distortion.worst_triangle);
    }
    flat_.distortion.worst_triangle = repair_.TriangleOf(flat_.distortion.worst_triangle);
    for (const std::uint32_t c : flat_.triangle_chart) ++flat_.charts[c].triangles;
  }

  void PlaceWelded() {
    bool welded = false;
    for (std::size_t t = repair_.given.size(); t-- > 0;) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = repair_.given[t][k], u = flat_.corner_uv[t][k];
        if (repair_.vertex[v] == v) continue;
        flat_.uv[v] = flat_.uv[u];
        flat_.first_step[v] = flat_.first_step[u];
        welded = true;
      }
    }
    if (welded) flat_.welded = repair_.vertex;
  }

  const Repair& repair_;
  Flattening& flat_;
  std::vector<std::uint32_t> chart_of_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<std::uint32_t> charts_;
  std::vector<std::array<double, 2>> values_;
};

}  // namespace

FlattenOptions OfMended(FlattenOptions options, const Repair& repair) {
  options.energy = repair.OfMended(std::move(options.energy));
  for (UvPin& pin : options.pins) pin.vertex = repair.VertexOf(pin.vertex);
  for (GrainLine& line : options.grain_lines) {
    line.from = repair.VertexOf(line.from);
    line.to = repair.VertexOf(line.to);
  }
  return options;
}

void OfGiven(const Repair& repair, Flattening& flat) { Translator(repair, flat).Run(); }

}  // namespace arap
