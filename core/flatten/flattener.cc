#include "arap/core/flattener.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/cpu_timer.h"
#include "core/base/try.h"
#include "core/cut/cut_surface.h"
#include "core/energy/cells.h"
#include "core/flatten/assembly.h"
#include "core/flatten/chart.h"
#include "core/flatten/chart_layout.h"
#include "core/flatten/layout/chart_factors.h"
#include "core/flatten/layout/wishes.h"

namespace arap {

// What a PreparedSurface keeps.
struct PreparedSurfaceParts {
  // At most `kept_factors` factors of each step and chart.
  PreparedSurfaceParts(CutSurface cut, std::size_t vertices, std::vector<Chart> made,
                       std::size_t kept_factors);

  CutSurface surface;  // without its mesh: the charts have it
  std::size_t input_vertices;
  std::vector<Chart> charts;
  mutable FactorCache factors;
};

namespace {

// What is done of the whole work, roughly, after each phase.
constexpr double kCutDone = 0.1, kChartsDone = 0.2, kLayoutDone = 0.9;

void Tell(const FlattenProgress& progress, std::string_view phase, double fraction) {
  if (progress) progress(phase, fraction);
}

// Factors kept by Prepare, of each step and chart.
constexpr std::size_t kKeptFactors = 8;
// Of each step in all: a surface of many more charts is flattened anew each time.
constexpr std::size_t kMaxKeptFactors = 1024;

template <class T>
std::size_t BytesOf(const std::vector<T>& values) {
  return values.capacity() * sizeof(T);
}

std::size_t BytesOf(const Topology& topology) {
  return BytesOf(topology.edges) + BytesOf(topology.triangle_edges) +
         BytesOf(topology.vertex_component) + BytesOf(topology.triangle_piece);
}

std::size_t BytesOf(const SurfaceMesh& mesh) {
  return BytesOf(mesh.vertices) + BytesOf(mesh.triangles);
}

Fault BadOption(std::string sentence, std::string field) {
  return Fault(FaultKind::kInvalidOption, std::move(sentence)).Field(std::move(field));
}

Status CheckEnergy(const FlattenOptions& options, std::size_t triangles) {
  const EnergyOptions& energy = options.energy;
  if (energy.basis == Basis::kVertex) {
    return Fail(BadOption("VERTEX cells are for planar meshes; a surface takes EDGE or FACE cells.",
                          "energy.basis")
                    .Detail("value", "BASIS_VERTEX"));
  }
  if (options.method == FlattenMethod::kAbf && energy.basis != Basis::kFace) {
    return Fail(BadOption("Angle-based flattening takes FACE cells only.", "energy.basis"));
  }
  if (options.method == FlattenMethod::kAbf && energy.weights != Weights::kCotangent) {
    return Fail(
        BadOption("Angle-based flattening takes cotangent weights only.", "energy.weights"));
  }
  return CheckEnergyOptions(energy, triangles);
}

// What can be said of a pin without the surface.
Status CheckPin(const UvPin& pin, std::size_t i) {
  const auto bad = [&](std::string sentence, std::string_view member, double value) {
    return Fail(BadOption(std::move(sentence), fmt::format("pins[{}].{}", i, member))
                    .Element(pin.vertex)
                    .Detail("value", value)
                    .Detail("limit", kMaxPinWeight));
  };
  if (!std::isfinite(pin.uv.real())) {
    return bad(fmt::format("pins[{}].u is NaN or infinite.", i), "u", pin.uv.real());
  }
  if (!std::isfinite(pin.uv.imag())) {
    return bad(fmt::format("pins[{}].v is NaN or infinite.", i), "v", pin.uv.imag());
  }
  // Written so that NaN fails too.
  if (pin.weight == 0 || (pin.weight >= kMinPinWeight && pin.weight <= kMaxPinWeight)) return {};
  return bad(fmt::format("pins[{}].weight is {}; it must be 0 or {:g} to {:g}.", i, pin.weight,
                         kMinPinWeight, kMaxPinWeight),
             "weight", pin.weight);
}

EnergyOptions EnergyOf(const Chart& chart, const EnergyOptions& energy) {
  EnergyOptions own{energy.basis, energy.weights, {}};
  if (energy.rigidity.empty()) return own;
  for (const std::uint32_t t : chart.triangles) own.rigidity.push_back(energy.rigidity[t]);
  return own;
}

// Triangles this much longer than high, which are accepted, can be too thin for some methods.
constexpr double kThin = 1e3;

// A chart that doubles could not lay flat: the fault of its thinnest triangle, where that is thin.
Fault Explained(Fault fault, const Chart& chart) {
  if (fault.kind != FaultKind::kNumerical) return fault;
  double most = 0;
  std::size_t thinnest = 0;
  for (std::uint32_t t = 0; t < chart.triangles.size(); ++t) {
    if (!chart.left_out.empty() && chart.left_out[t]) continue;
    const auto p = chart.Frame(t);
    const double longest =
        std::max({std::norm(p[1] - p[0]), std::norm(p[2] - p[1]), std::norm(p[2] - p[0])});
    const double aspect = longest / (p[1].real() * p[2].imag());
    if (aspect > most) most = aspect, thinnest = t;
  }
  if (!(most > kThin)) return fault;
  return Fault(FaultKind::kDegenerateTriangle,
               fmt::format(
                   "Triangle {} is {:.0e} times as long as high: too thin for its chart to be "
                   "laid flat in double precision.",
                   chart.triangles[thinnest], most))
      .Field("mesh.triangles")
      .Element(chart.triangles[thinnest])
      .Detail("aspect", most)
      .Detail("cause", fault.message);
}

// What kept a chart from an injective layout, with the numbers of the input instead of the chart's.
// `source` (#U) is the input vertex of each vertex of the cut surface.
Fault OfInput(Fault fault, const Chart& chart, std::span<const std::uint32_t> source) {
  if (fault.kind != FaultKind::kNotInjective) return fault;
  const bool held = fault.field == "pins";
  const auto vertex = [&](std::uint32_t v) { return source[chart.vertices[v]]; };
  if (held) {
    const std::uint32_t t = fault.elements.front();
    const auto& [a, b, c] = chart.mesh.triangles[t];
    fault.message = fmt::format("The pins of vertices {}, {} and {} flip triangle {}.", vertex(a),
                                vertex(b), vertex(c), chart.triangles[t]);
  }
  const bool triangles = held || !DetailOf(fault, "flipped").empty();
  for (std::uint32_t& id : fault.elements) id = triangles ? chart.triangles[id] : vertex(id);
  return fault;
}

// Lays the mended surface flat.
Result<Flattening> LayFlat(const PreparedSurfaceParts& surface, const FlattenOptions& options,
                           const CancelToken& cancel, PinSolver solver,
                           const FlattenProgress& progress) {
  CpuTimer timer;
  TRY(const auto wishes,
      FindWishes(surface.charts, surface.surface.source, surface.input_vertices, options, cancel));
  Assembly assembly(surface.surface, surface.charts);
  const auto triangles = static_cast<double>(surface.surface.turned.size());
  std::size_t laid = 0;
  for (std::size_t c = 0; c < surface.charts.size(); ++c) {
    CHECK_OK(cancel.Check());
    Tell(progress, "layout",
         kChartsDone + (kLayoutDone - kChartsDone) * static_cast<double>(laid) / triangles);
    const Chart& chart = surface.charts[c];
    laid += chart.triangles.size();
    auto layout = LayOutChart(chart, options, EnergyOf(chart, options.energy), solver, wishes[c],
                              fmt::to_string(c), surface.factors, cancel);
    if (!layout) {
      layout.error() = OfInput(std::move(layout.error()), chart, surface.surface.source);
      // Who demands one way of solving is told of it.
      if (solver == PinSolver::kNullSpace) return Fail(std::move(layout).error());
      return Fail(Explained(std::move(layout).error(), chart));
    }
    assembly.Add(chart, *std::move(layout));
  }
  TRY(auto flat, assembly.Finish(wishes, options, cancel));
  flat.times.solve = timer.Lap() - flat.times.order - flat.times.factor;
  return flat;
}

// Flattens what is cut already; the times have no share for cutting it.
Result<Flattening> FlattenPrepared(const PreparedSurfaceParts& surface,
                                   const FlattenOptions& options, const CancelToken& cancel,
                                   PinSolver solver, const FlattenProgress& progress) {
  const Repair& repair = surface.surface.repair;
  if (!repair.changed()) {
    CHECK_OK(CheckFlattenOptions(options, surface.surface.turned.size()));
    return LayFlat(surface, options, cancel, solver, progress);
  }
  CHECK_OK(CheckFlattenOptions(options, repair.given.size()));
  auto flat = LayFlat(surface, OfMended(options, repair), cancel, solver, progress);
  if (!flat) return Fail(repair.OfGiven(std::move(flat.error())));
  OfGiven(repair, *flat);
  return flat;
}

}  // namespace

Status CheckFlattenOptions(const FlattenOptions& options, std::size_t triangles) {
  if (options.refine < 0 || options.refine > kMaxFlattenRefine) {
    return Fail(BadOption(fmt::format("refine is {}; it must be 0 to {}.", options.refine,
                                      kMaxFlattenRefine),
                          "refine")
                    .Detail("value", options.refine)
                    .Detail("limit", kMaxFlattenRefine));
  }
  // Written so that NaN fails too.
  if (!(options.refine_stop >= 0 && options.refine_stop <= 1)) {
    return Fail(BadOption(fmt::format("refine_stop is {}; it must be 0 to 1.", options.refine_stop),
                          "refine_stop")
                    .Detail("value", options.refine_stop)
                    .Detail("limit", 1));
  }
  CHECK_OK(CheckRepair(options.cut.repair));
  CHECK_OK(CheckEnergy(options, triangles));
  for (std::size_t i = 0; i < options.pins.size(); ++i) CHECK_OK(CheckPin(options.pins[i], i));
  for (std::size_t i = 0; i < options.grain_lines.size(); ++i) {
    const double angle = options.grain_lines[i].angle;
    if (std::isfinite(angle)) continue;
    return Fail(BadOption(fmt::format("The angle of grain_lines[{}] is NaN or infinite.", i),
                          fmt::format("grain_lines[{}].angle", i))
                    .Detail("value", angle));
  }
  return {};
}

PreparedSurfaceParts::PreparedSurfaceParts(CutSurface cut, std::size_t vertices,
                                           std::vector<Chart> made, std::size_t kept_factors)
    : surface(std::move(cut)),
      input_vertices(vertices),
      charts(std::move(made)),
      factors(std::min(kMaxKeptFactors, kept_factors * charts.size())) {}

PreparedSurface::PreparedSurface(std::unique_ptr<const PreparedSurfaceParts> parts)
    : parts_(std::move(parts)) {}

PreparedSurface::~PreparedSurface() = default;

std::size_t PreparedSurface::bytes() const {
  std::size_t bytes = BytesOf(parts_->surface.source) + BytesOf(parts_->surface.repair.given) +
                      BytesOf(parts_->surface.repair.vertex) +
                      BytesOf(parts_->surface.repair.triangle) + parts_->factors.bytes();
  for (const Chart& chart : parts_->charts) {
    bytes += sizeof(Chart) + chart.left_out.capacity() / 8;
    for (const auto& loop : chart.loops) bytes += sizeof(loop) + BytesOf(loop);
    bytes += BytesOf(chart.mesh) + BytesOf(chart.topology) + BytesOf(chart.vertices) +
             BytesOf(chart.triangles);
  }
  return bytes;
}

namespace {

Result<std::shared_ptr<const PreparedSurface>> PrepareSurface(SurfaceMesh mesh,
                                                              const CutOptions& cut,
                                                              const MeshLimits& limits,
                                                              const CancelToken& cancel) {
  const std::size_t vertices = mesh.vertices.size();
  TRY(auto surface, CutToCharts(std::move(mesh), cut, limits, cancel));
  TRY(auto charts, MakeCharts(surface, true, cancel));
  return std::make_shared<const PreparedSurface>(std::make_unique<const PreparedSurfaceParts>(
      std::move(surface), vertices, std::move(charts), kKeptFactors));
}

Result<Flattening> FlattenAtOnce(SurfaceMesh mesh, const FlattenOptions& options,
                                 const MeshLimits& limits, const CancelToken& cancel,
                                 PinSolver solver, const FlattenProgress& progress) {
  CHECK_OK(CheckFlattenOptions(options, mesh.triangles.size()));
  CpuTimer timer;
  const std::size_t vertices = mesh.vertices.size();
  Tell(progress, "cutting", 0);
  TRY(auto surface, CutToCharts(std::move(mesh), options.cut, limits, cancel));
  Tell(progress, "charts", kCutDone);
  const bool edges = options.energy.basis != Basis::kFace || options.method == FlattenMethod::kAbf;
  TRY(auto charts, MakeCharts(surface, edges, cancel));
  // This surface is not flattened again: no factor is kept.
  const PreparedSurfaceParts prepared(std::move(surface), vertices, std::move(charts), 0);
  const double topology = timer.Lap();
  TRY(auto flat, FlattenPrepared(prepared, options, cancel, solver, progress));
  flat.times.topology = topology;
  return flat;
}

}  // namespace

Result<std::shared_ptr<const PreparedSurface>> Prepare(SurfaceMesh mesh, const CutOptions& cut,
                                                       const MeshLimits& limits,
                                                       const CancelToken& cancel) {
  return OrOutOfMemory([&] { return PrepareSurface(std::move(mesh), cut, limits, cancel); });
}

Result<Flattening> Flatten(const PreparedSurface& surface, const FlattenOptions& options,
                           const CancelToken& cancel, PinSolver solver,
                           const FlattenProgress& progress) {
  return OrOutOfMemory(
      [&] { return FlattenPrepared(surface.parts(), options, cancel, solver, progress); });
}

Result<Flattening> Flatten(SurfaceMesh mesh, const FlattenOptions& options,
                           const MeshLimits& limits, const CancelToken& cancel, PinSolver solver,
                           const FlattenProgress& progress) {
  return OrOutOfMemory(
      [&] { return FlattenAtOnce(std::move(mesh), options, limits, cancel, solver, progress); });
}

}  // namespace arap
