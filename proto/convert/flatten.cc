#include "proto/convert/flatten.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <arap/v1/flattening_service.pb.h>
#include <fmt/format.h>

#include "core/base/try.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"

namespace arap::convert {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

Fault BadOption(std::string message, std::string field, std::string value) {
  return Fault(FaultKind::kInvalidOption, std::move(message))
      .Field(std::move(field))
      .Detail("value", std::move(value));
}

// What a method of the wire means: its preset, and which cells it may have.
struct Recipe {
  FlattenOptions preset;
  std::vector<Basis> bases;
  bool conformal = false;  // angles only: with cotangent weights
};

Result<Recipe> RecipeOf(v1::FlattenMethod method) {
  using enum Basis;
  switch (method) {
    case v1::FLATTEN_METHOD_UNSPECIFIED:
      return Recipe{ArapOptions(), {kFace, kEdge, kEdgeAsPublished}};
    case v1::FLATTEN_METHOD_ARAP_EDGE:
      return Recipe{ArapOptions(kEdge), {kEdge, kEdgeAsPublished}};
    case v1::FLATTEN_METHOD_ARAP_FACE:
      return Recipe{ArapOptions(), {kFace}};
    case v1::FLATTEN_METHOD_LSCM:
      return Recipe{LscmOptions(), {kFace}, true};
    case v1::FLATTEN_METHOD_FIRST_STEP:
      return Recipe{FirstStepOptions(), {kEdge, kEdgeAsPublished, kFace}};
    case v1::FLATTEN_METHOD_ABF:
      return Recipe{AbfOptions(), {kFace}, true};
    default:
      return Fail(UnknownValue("method", method));
  }
}

// The method of the wire that goes with any basis and says the same.
v1::FlattenMethod ToWire(FlattenMethod method) {
  switch (method) {
    case FlattenMethod::kArap:
      return v1::FLATTEN_METHOD_UNSPECIFIED;
    case FlattenMethod::kFirstStep:
      return v1::FLATTEN_METHOD_FIRST_STEP;
    case FlattenMethod::kAbf:
      return v1::FLATTEN_METHOD_ABF;
  }
  return v1::FLATTEN_METHOD_UNSPECIFIED;
}

Result<EnergyOptions> EnergyOf(const v1::FlattenRequest& request, const Recipe& recipe) {
  const std::string method = v1::FlattenMethod_Name(request.method());
  TRY(EnergyOptions energy, FromWire(request.energy(), recipe.preset.energy));
  // VERTEX cells are no contradiction of the method: no surface has them, as the core says.
  if (energy.basis != Basis::kVertex &&
      std::find(recipe.bases.begin(), recipe.bases.end(), energy.basis) == recipe.bases.end()) {
    const std::string basis = v1::Basis_Name(request.energy().basis());
    return Fail(
        BadOption(fmt::format("{} does not go with {}.", basis, method), "energy.basis", basis));
  }
  if (recipe.conformal && energy.weights != Weights::kCotangent) {
    const std::string weights = v1::EdgeWeights_Name(request.energy().weights());
    return Fail(BadOption(fmt::format("{} does not go with {}.", weights, method), "energy.weights",
                          weights));
  }
  return energy;
}

constexpr EnumRow<v1::FlattenAnchors, FlattenAnchors> kAnchors[] = {
    {v1::FLATTEN_ANCHORS_CENTER_EDGE, FlattenAnchors::kCentreEdge},
    {v1::FLATTEN_ANCHORS_FAR_BOUNDARY, FlattenAnchors::kFarBoundary},
    {v1::FLATTEN_ANCHORS_SPECTRAL, FlattenAnchors::kSpectral},
};
static_assert(std::size(kAnchors) == v1::FlattenAnchors_ARRAYSIZE - 1);

Status SetRefine(const v1::FlattenRequest& request, std::uint32_t max_refine,
                 FlattenOptions& options) {
  if (request.refine() > max_refine) {
    return Fail(BadOption(fmt::format("refine of {} is more than max_refine of {}.",
                                      request.refine(), max_refine),
                          "refine", std::to_string(request.refine()))
                    .Detail("quota", "max_refine")
                    .Detail("limit", max_refine));
  }
  const auto preset = static_cast<std::uint32_t>(options.refine);
  options.refine =
      static_cast<int>(request.has_refine() ? request.refine() : std::min(preset, max_refine));
  if (request.has_refine_stop()) options.refine_stop = request.refine_stop();
  return {};
}

std::vector<UvPin> PinsOf(const v1::FlattenRequest& request) {
  std::vector<UvPin> pins;
  for (const v1::UvPin& pin : request.pins()) {
    pins.push_back({pin.vertex(), {pin.u(), pin.v()}, pin.weight()});
  }
  return pins;
}

void ToWire(const UvPin& pin, v1::UvPin* out) {
  out->set_vertex(pin.vertex);
  out->set_u(pin.uv.real());
  out->set_v(pin.uv.imag());
  out->set_weight(pin.weight);
}

std::vector<GrainLine> GrainLinesOf(const v1::FlattenRequest& request) {
  std::vector<GrainLine> lines;
  for (const v1::GrainLine& line : request.grain_lines()) {
    // Whole turns do not count, and what is left is exact.
    const double degrees = std::fmod(line.angle_degrees(), 360.0);
    lines.push_back({line.from_vertex(), line.to_vertex(), degrees * kRadiansPerDegree});
  }
  return lines;
}

// The degrees that are read back as these radians where there are such; else the nearest.
double Degrees(double radians) {
  const double degrees = radians / kRadiansPerDegree;
  for (const double near : {std::nextafter(degrees, -1e9), std::nextafter(degrees, 1e9)}) {
    if (near * kRadiansPerDegree == radians && degrees * kRadiansPerDegree != radians) return near;
  }
  return degrees;
}

void ToWire(const GrainLine& line, v1::GrainLine* out) {
  out->set_from_vertex(line.from);
  out->set_to_vertex(line.to);
  out->set_angle_degrees(Degrees(line.angle));
}

Distortion FromWire(const v1::Distortion& distortion) {
  Distortion out;
  out.arap_energy = distortion.arap_energy();
  out.symmetric_dirichlet = distortion.symmetric_dirichlet();
  out.area_ratio = distortion.area_ratio();
  out.mean_stretch_percent = distortion.mean_stretch_percent();
  out.max_stretch_percent = distortion.max_stretch_percent();
  out.mean_compression_percent = distortion.mean_compression_percent();
  out.max_compression_percent = distortion.max_compression_percent();
  out.mean_angle_degrees = distortion.mean_angle_degrees();
  out.max_angle_degrees = distortion.max_angle_degrees();
  out.flipped = distortion.flipped();
  out.worst_triangle = distortion.worst_triangle();
  return out;
}

void ToWire(const Distortion& distortion, v1::Distortion* out) {
  out->set_arap_energy(distortion.arap_energy);
  out->set_symmetric_dirichlet(distortion.symmetric_dirichlet);
  out->set_area_ratio(distortion.area_ratio);
  out->set_mean_stretch_percent(distortion.mean_stretch_percent);
  out->set_max_stretch_percent(distortion.max_stretch_percent);
  out->set_mean_compression_percent(distortion.mean_compression_percent);
  out->set_max_compression_percent(distortion.max_compression_percent);
  out->set_mean_angle_degrees(distortion.mean_angle_degrees);
  out->set_max_angle_degrees(distortion.max_angle_degrees);
  out->set_flipped(distortion.flipped);
  out->set_scale(1);  // results are true to size
  out->set_worst_triangle(distortion.worst_triangle);
}

// What a newer server may say is as if it said nothing.
RefineEnd FromWire(v1::RefineEnd end) {
  if (end == v1::REFINE_END_CONVERGED) return RefineEnd::kConverged;
  if (end == v1::REFINE_END_LIMIT) return RefineEnd::kLimit;
  return RefineEnd::kNotRefined;
}

v1::RefineEnd ToWire(RefineEnd end) {
  switch (end) {
    case RefineEnd::kNotRefined:
      return v1::REFINE_END_UNSPECIFIED;
    case RefineEnd::kConverged:
      return v1::REFINE_END_CONVERGED;
    case RefineEnd::kLimit:
      return v1::REFINE_END_LIMIT;
  }
  return v1::REFINE_END_UNSPECIFIED;
}

FlatChart FromWire(const v1::FlatChart& chart) {
  FlatChart out;
  for (const v1::FlatLoop& loop : chart.loops()) {
    out.loops.push_back(Values<std::uint32_t>(loop.uv_indices()));
  }
  out.anchors = Values<std::uint32_t>(chart.anchors());
  out.triangles = chart.triangle_count();
  out.distortion = FromWire(chart.distortion());
  out.crossings = chart.boundary_crossings();
  out.refinements = static_cast<int>(chart.refinements());
  out.refine_end = FromWire(chart.refine_end());
  return out;
}

void ToWire(const FlatChart& chart, v1::FlatChart* out) {
  for (const auto& loop : chart.loops) {
    Append(loop, out->add_loops()->mutable_uv_indices());
  }
  Append(chart.anchors, out->mutable_anchors());
  out->set_triangle_count(chart.triangles);
  ToWire(chart.distortion, out->mutable_distortion());
  out->set_boundary_crossings(chart.crossings);
  out->set_refinements(static_cast<std::uint32_t>(chart.refinements));
  out->set_refine_end(ToWire(chart.refine_end));
}

Status PackSingularValues(const Flattening& flat, Array<float>* out) {
  AppendGroups(flat.singular_values, out);
  if (std::all_of(out->begin(), out->end(), [](float value) { return std::isfinite(value); })) {
    return {};
  }
  return Fail(FaultKind::kNumerical, "A singular value of the result is not a finite float.");
}

}  // namespace

Result<FlattenOptions> FromWire(const v1::FlattenRequest& request, std::uint32_t max_refine) {
  TRY(const Recipe recipe, RecipeOf(request.method()));
  FlattenOptions options = recipe.preset;
  TRY(options.energy, EnergyOf(request, recipe));
  TRY(options.anchors, ModelOf(kAnchors, request.anchors(), recipe.preset.anchors, "anchors"));
  options.injective = request.injective();
  CHECK_OK(SetRefine(request, max_refine, options));
  CHECK_OK(CheckGroups(request.seam_edges_size(), 2, "seam_edges"));
  options.cut.seams = Groups<std::uint32_t, 2>(request.seam_edges());
  options.cut.repair = FromWire(request.repair());
  options.cut.auto_cut = request.auto_cut();
  options.cut.split_non_manifold = request.split_non_manifold();
  options.cut.tolerate_degenerate = request.tolerate_degenerate();
  options.pins = PinsOf(request);
  options.grain_lines = GrainLinesOf(request);
  return options;
}

void ToWire(const FlattenOptions& options, v1::FlattenRequest* out) {
  out->set_method(ToWire(options.method));
  ToWire(options.energy, out->mutable_energy());
  out->set_anchors(WireOf(kAnchors, options.anchors));
  out->set_injective(options.injective);
  const int preset = options.method == FlattenMethod::kArap ? kServiceRefine : 0;
  if (options.refine != preset) out->set_refine(static_cast<std::uint32_t>(options.refine));
  out->set_refine_stop(options.refine_stop);
  AppendGroups(options.cut.seams, out->mutable_seam_edges());
  if (options.cut.repair != RepairOptions{}) ToWire(options.cut.repair, out->mutable_repair());
  out->set_auto_cut(options.cut.auto_cut);
  out->set_split_non_manifold(options.cut.split_non_manifold);
  out->set_tolerate_degenerate(options.cut.tolerate_degenerate);
  for (const UvPin& pin : options.pins) ToWire(pin, out->add_pins());
  for (const GrainLine& line : options.grain_lines) ToWire(line, out->add_grain_lines());
}

Fault SpelledForFlatten(Fault fault) {
  constexpr std::string_view kSeams = "seams[", kGrainLines = "grain_lines[", kAngle = "].angle";
  if (fault.field.starts_with(kSeams)) {
    const std::string_view field = fault.field;
    std::size_t seam = 0;
    std::from_chars(field.data() + kSeams.size(), field.data() + field.size(), seam);
    fault.field = fmt::format("seam_edges[{}]", 2 * seam);
  } else if (fault.field.starts_with(kGrainLines) && fault.field.ends_with(kAngle)) {
    fault.field += "_degrees";
  }
  return fault;
}

Status ToWire(const Flattening& flat, const v1::FlattenRequest& request, v1::FlattenResponse* out) {
  if (request.float64()) {
    CHECK_OK(PackPoints(flat.uv, out->mutable_uv64()));
  } else {
    CHECK_OK(PackPoints(flat.uv, out->mutable_uv()));
  }
  if (request.include_first_step()) {
    CHECK_OK(PackPoints(flat.first_step, out->mutable_first_step_uv()));
  }
  if (request.include_singular_values()) {
    CHECK_OK(PackSingularValues(flat, out->mutable_singular_values()));
  }
  Append(flat.source, out->mutable_uv_vertex());
  Append(flat.welded, out->mutable_welded_vertex());
  AppendGroups(flat.corner_uv, out->mutable_corner_uv());
  Append(flat.triangle_chart, out->mutable_triangle_chart());
  ToWire(flat.distortion, out->mutable_distortion());
  for (const FlatChart& chart : flat.charts) ToWire(chart, out->add_charts());
  if (!flat.charts.empty()) {
    for (const std::uint32_t anchor : flat.charts.front().anchors) {
      out->add_anchor_vertices(flat.source[anchor]);
    }
  }
  ToWire(flat.warnings, out->mutable_warnings());
  AppendGroups(flat.cuts, out->mutable_cut_edges());
  out->set_auto_cut_count(static_cast<std::uint32_t>(flat.auto_cuts));
  Append(flat.degenerate, out->mutable_left_out_triangles());
  out->set_boundary_overlaps(flat.overlaps);
  return {};
}

Result<Flattening> FromWire(const v1::FlattenResponse& response) {
  const int odd = response.uv_size() % 2 + response.uv64_size() % 2 +
                  response.corner_uv_size() % 3 + response.first_step_uv_size() % 2 +
                  response.singular_values_size() % 2 + response.cut_edges_size() % 2;
  if (odd != 0) {
    return Fail(FaultKind::kInternal, "The server answered an array of a wrong length.");
  }
  Flattening flat;
  flat.uv = response.uv64_size() > 0 ? Points(response.uv64()) : Points(response.uv());
  flat.source = Values<std::uint32_t>(response.uv_vertex());
  flat.welded = Values<std::uint32_t>(response.welded_vertex());
  flat.corner_uv = Groups<std::uint32_t, 3>(response.corner_uv());
  flat.first_step = Points(response.first_step_uv());
  flat.singular_values = Groups<double, 2>(response.singular_values());
  flat.distortion = FromWire(response.distortion());
  flat.warnings = FromWire(response.warnings());
  for (const v1::FlatChart& chart : response.charts()) flat.charts.push_back(FromWire(chart));
  flat.triangle_chart = Values<std::uint32_t>(response.triangle_chart());
  flat.cuts = Groups<std::uint32_t, 2>(response.cut_edges());
  flat.auto_cuts = response.auto_cut_count();
  flat.degenerate = Values<std::uint32_t>(response.left_out_triangles());
  flat.overlaps = response.boundary_overlaps();
  return flat;
}

}  // namespace arap::convert
