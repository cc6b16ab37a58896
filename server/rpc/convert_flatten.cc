// What is asked of a flattening, from the wire to the core.
#include "server/rpc/convert_flatten.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <arap/v1/flattening_service.pb.h>
#include <fmt/format.h>

#include "server/rpc/convert_mesh.h"

namespace arap::rpc {
namespace {

constexpr std::uint32_t kDefaultRefine = 20;
constexpr double kDefaultRefineStop = 1e-6;

Fault BadOption(std::string message, std::string field, std::string value) {
  return Fault(FaultKind::kInvalidOption, std::move(message))
      .Field(std::move(field))
      .Detail("value", std::move(value));
}

// What a method means: which cells it may have, the first of them when the request names none.
struct Recipe {
  FlattenMethod method = FlattenMethod::kArap;
  std::vector<Basis> bases;
  bool conformal = false;  // angles only: cotangent weights, and no anchors unless asked
  std::uint32_t refine = 0;
};

Result<Recipe> RecipeOf(v1::FlattenMethod method) {
  using enum Basis;
  switch (method) {
    case v1::FLATTEN_METHOD_UNSPECIFIED:
      return Recipe{FlattenMethod::kArap, {kFace, kEdge, kEdgeAsPublished}, false, kDefaultRefine};
    case v1::FLATTEN_METHOD_ARAP_EDGE:
      return Recipe{FlattenMethod::kArap, {kEdge, kEdgeAsPublished}, false, kDefaultRefine};
    case v1::FLATTEN_METHOD_ARAP_FACE:
      return Recipe{FlattenMethod::kArap, {kFace}, false, kDefaultRefine};
    case v1::FLATTEN_METHOD_LSCM:
      return Recipe{FlattenMethod::kFirstStep, {kFace}, true, 0};
    case v1::FLATTEN_METHOD_FIRST_STEP:
      return Recipe{FlattenMethod::kFirstStep, {kEdge, kEdgeAsPublished, kFace}, false, 0};
    case v1::FLATTEN_METHOD_ABF:
      return Recipe{FlattenMethod::kAbf, {kFace}, true, 0};
    default:
      return Fail(UnknownValue("method", method));
  }
}

Result<EnergyOptions> EnergyOf(const v1::FlattenRequest& request, const Recipe& recipe) {
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size() / 3);
  auto energy = FromWire(request.energy(), Weights::kCotangent, triangles);
  if (!energy) return energy;
  if (request.energy().basis() == v1::BASIS_UNSPECIFIED) energy->basis = recipe.bases.front();
  // VERTEX cells are no contradiction of the method: no surface has them, as the core says.
  if (energy->basis != Basis::kVertex &&
      std::find(recipe.bases.begin(), recipe.bases.end(), energy->basis) == recipe.bases.end()) {
    const std::string basis = v1::Basis_Name(request.energy().basis());
    return Fail(BadOption(
        fmt::format("{} does not go with {}.", basis, v1::FlattenMethod_Name(request.method())),
        "energy.basis", basis));
  }
  if (recipe.conformal && energy->weights != Weights::kCotangent) {
    const std::string weights = v1::EdgeWeights_Name(request.energy().weights());
    return Fail(BadOption(
        fmt::format("{} does not go with {}.", weights, v1::FlattenMethod_Name(request.method())),
        "energy.weights", weights));
  }
  return energy;
}

Result<FlattenAnchors> AnchorsOf(v1::FlattenAnchors anchors, const Recipe& recipe) {
  switch (anchors) {
    case v1::FLATTEN_ANCHORS_UNSPECIFIED:
      return recipe.conformal ? FlattenAnchors::kSpectral : FlattenAnchors::kCentreEdge;
    case v1::FLATTEN_ANCHORS_SPECTRAL:
      return FlattenAnchors::kSpectral;
    case v1::FLATTEN_ANCHORS_CENTER_EDGE:
      return FlattenAnchors::kCentreEdge;
    case v1::FLATTEN_ANCHORS_FAR_BOUNDARY:
      return FlattenAnchors::kFarBoundary;
    default:
      return Fail(UnknownValue("anchors", anchors));
  }
}

Status SetRefine(const v1::FlattenRequest& request, const Recipe& recipe, const app::Limits& limits,
                 FlattenOptions& options) {
  if (request.refine() > limits.max_refine) {
    Fault fault = BadOption(fmt::format("refine of {} is more than max_refine of {}.",
                                        request.refine(), limits.max_refine),
                            "refine", std::to_string(request.refine()));
    return Fail(
        fault.Detail("quota", "max_refine").Detail("limit", std::to_string(limits.max_refine)));
  }
  options.refine = static_cast<int>(
      request.has_refine() ? request.refine() : std::min(recipe.refine, limits.max_refine));
  options.refine_stop = request.has_refine_stop() ? request.refine_stop() : kDefaultRefineStop;
  return {};
}

Status SetCut(const v1::FlattenRequest& request, CutOptions& cut) {
  const int numbers = request.seam_edges_size();
  if (numbers % 2 != 0) {
    Fault fault = Fault(FaultKind::kArrayLength,
                        fmt::format("seam_edges has {} numbers, not a multiple of 2.", numbers))
                      .Field("seam_edges");
    return Fail(
        fault.Detail("length", std::to_string(numbers)).Detail("expected", "a multiple of 2"));
  }
  cut.seams.reserve(static_cast<std::size_t>(numbers / 2));
  for (int i = 0; i < numbers; i += 2) {
    cut.seams.push_back({request.seam_edges(i), request.seam_edges(i + 1)});
  }
  cut.auto_cut = request.auto_cut();
  cut.split_non_manifold = request.split_non_manifold();
  cut.tolerate_degenerate = request.tolerate_degenerate();
  return {};
}

std::vector<UvPin> PinsOf(const v1::FlattenRequest& request) {
  std::vector<UvPin> pins;
  for (const v1::UvPin& pin : request.pins()) {
    pins.push_back({pin.vertex(), {pin.u(), pin.v()}, pin.weight()});
  }
  return pins;
}

std::vector<GrainLine> GrainLinesOf(const v1::FlattenRequest& request) {
  std::vector<GrainLine> lines;
  for (const v1::GrainLine& line : request.grain_lines()) {
    // Whole turns do not count, and what is left is exact.
    const double degrees = std::fmod(line.angle_degrees(), 360.0);
    lines.push_back({line.from_vertex(), line.to_vertex(), degrees * (std::numbers::pi / 180)});
  }
  return lines;
}

}  // namespace

Status CheckBudget(const v1::FlattenRequest& request, const app::Limits& limits) {
  const auto triangles = static_cast<std::size_t>(request.mesh().triangles_size() / 3);
  const std::size_t limit = limits.max_flatten_triangles;
  if (triangles <= limit) return {};
  Fault fault =
      Fault(FaultKind::kLimitExceeded,
            fmt::format("The surface has {} triangles, more than max_flatten_triangles of {}.",
                        triangles, limit))
          .Field("mesh.triangles");
  return Fail(fault.Detail("count", std::to_string(triangles))
                  .Detail("quota", "max_flatten_triangles")
                  .Detail("limit", std::to_string(limit)));
}

Result<FlattenOptions> FromWire(const v1::FlattenRequest& request, const app::Limits& limits) {
  auto recipe = RecipeOf(request.method());
  if (!recipe) return Fail(std::move(recipe.error()));
  auto energy = EnergyOf(request, *recipe);
  if (!energy) return Fail(std::move(energy.error()));
  auto anchors = AnchorsOf(request.anchors(), *recipe);
  if (!anchors) return Fail(std::move(anchors.error()));
  FlattenOptions options;
  options.method = recipe->method;
  options.energy = *std::move(energy);
  options.anchors = *anchors;
  options.injective = request.injective();
  if (auto ok = SetRefine(request, *recipe, limits, options); !ok)
    return Fail(std::move(ok.error()));
  if (auto ok = SetCut(request, options.cut); !ok) return Fail(std::move(ok.error()));
  options.pins = PinsOf(request);
  options.grain_lines = GrainLinesOf(request);
  return options;
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

}  // namespace arap::rpc
