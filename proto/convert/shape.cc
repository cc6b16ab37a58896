#include "proto/convert/shape.h"

#include <algorithm>
#include <cmath>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>

#include "core/base/try.h"
#include "proto/convert/plain.h"

namespace arap::convert {
namespace {

Result<DeformMode> FromWire(v1::DeformMode mode) {
  switch (mode) {
    case v1::DEFORM_MODE_UNSPECIFIED:
    case v1::DEFORM_MODE_RIGID:
      return DeformMode::kRigid;
    case v1::DEFORM_MODE_SIMILARITY:
      return DeformMode::kSimilarity;
    case v1::DEFORM_MODE_BASELINE:
      return DeformMode::kBaseline;
    default:
      return Fail(UnknownValue("options.mode", mode));
  }
}

v1::DeformMode ToWire(DeformMode mode) {
  switch (mode) {
    case DeformMode::kRigid:
      return v1::DEFORM_MODE_RIGID;
    case DeformMode::kSimilarity:
      return v1::DEFORM_MODE_SIMILARITY;
    case DeformMode::kBaseline:
      return v1::DEFORM_MODE_BASELINE;
  }
  return v1::DEFORM_MODE_UNSPECIFIED;
}

}  // namespace

Result<DeformOptions> FromWire(const v1::DeformOptions& options, std::uint32_t max_refine) {
  DeformOptions out;
  TRY(out.mode, FromWire(options.mode()));
  if (options.refine() > max_refine) {
    return Fail(Fault(FaultKind::kInvalidOption,
                      fmt::format("options.refine of {} is more than max_refine of {}.",
                                  options.refine(), max_refine))
                    .Field("options.refine")
                    .Detail("value", options.refine())
                    .Detail("quota", "max_refine")
                    .Detail("limit", max_refine));
  }
  out.refine = static_cast<int>(options.refine());
  return out;
}

void ToWire(const DeformOptions& options, v1::DeformOptions* out) {
  out->set_mode(ToWire(options.mode));
  out->set_refine(static_cast<std::uint32_t>(options.refine));
}

Result<std::vector<Complex>> PicksFromWire(const google::protobuf::RepeatedField<double>& numbers) {
  const auto count = static_cast<std::size_t>(numbers.size());
  if (count % 2 != 0 || count > 2 * kMaxPicks) {
    return Fail(
        Fault(FaultKind::kArrayLength,
              fmt::format("pick_points has {} numbers; it needs x y pairs, at most {} of them.",
                          count, kMaxPicks))
            .Field("pick_points")
            .Detail("length", count)
            .Detail("limit", 2 * kMaxPicks));
  }
  std::vector<Complex> picks = Points(numbers);
  for (std::size_t i = 0; i < picks.size(); ++i) {
    if (std::isfinite(picks[i].real()) && std::isfinite(picks[i].imag())) continue;
    return Fail(
        Fault(FaultKind::kNonFiniteTarget, fmt::format("Pick point {} is NaN or infinite.", i))
            .Field(fmt::format("pick_points[{}]", 2 * i))
            .Element(static_cast<std::uint32_t>(i)));
  }
  return picks;
}

std::optional<Pick> FromWire(const v1::PickResult& result) {
  if (!result.hit()) return std::nullopt;
  Pick pick;
  pick.triangle = result.triangle();
  pick.rest = {result.rest().x(), result.rest().y()};
  const auto count = std::min(pick.barycentric.size(), std::size_t(result.barycentric_size()));
  std::copy_n(result.barycentric().begin(), count, pick.barycentric.begin());
  return pick;
}

void ToWire(const std::optional<Pick>& pick, v1::PickResult* out) {
  if (!pick) return;
  out->set_hit(true);
  out->set_triangle(pick->triangle);
  out->mutable_rest()->set_x(pick->rest.real());
  out->mutable_rest()->set_y(pick->rest.imag());
  Append(pick->barycentric, out->mutable_barycentric());
}

Status ToWire(std::span<const Complex> positions, bool float64, v1::Shape* out) {
  return float64 ? PackPoints(positions, out->mutable_positions64())
                 : PackPoints(positions, out->mutable_positions());
}

Result<std::vector<Complex>> PositionsFromWire(const v1::Shape& shape) {
  if (shape.positions_size() % 2 != 0 || shape.positions64_size() % 2 != 0) {
    return Fail(FaultKind::kInternal, "The server answered half a position.");
  }
  return shape.positions64_size() > 0 ? Points(shape.positions64()) : Points(shape.positions());
}

ShapeQuality QualityFromWire(const v1::Shape& shape) {
  ShapeQuality quality;
  quality.flipped = shape.flipped_count();
  quality.worst_handle_error = shape.worst_handle_error();
  quality.energy = shape.energy();
  quality.mean_stretch = shape.mean_stretch();
  quality.max_stretch = shape.max_stretch();
  return quality;
}

void ToWire(const ShapeQuality& quality, v1::Shape* out) {
  out->set_flipped_count(quality.flipped);
  out->set_worst_handle_error(quality.worst_handle_error);
  out->set_energy(quality.energy);
  out->set_mean_stretch(quality.mean_stretch);
  out->set_max_stretch(quality.max_stretch);
}

}  // namespace arap::convert
