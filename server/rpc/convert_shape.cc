#include "server/rpc/convert_shape.h"

#include <cmath>
#include <limits>

#include <arap/v1/deformation_service.pb.h>
#include <fmt/format.h>

#include "arap/core/pick.h"
#include "server/budget/limits.h"

namespace arap::rpc {
namespace {

template <class Number>
Status Pack(std::span<const Complex> points, google::protobuf::RepeatedField<Number>* out) {
  constexpr auto kLargest = static_cast<double>(std::numeric_limits<Number>::max());
  out->Resize(static_cast<int>(2 * points.size()), 0);
  Number* next = out->mutable_data();
  bool finite = true;
  for (const Complex point : points) {
    // Written so that NaN fails too.
    finite = finite && std::abs(point.real()) <= kLargest && std::abs(point.imag()) <= kLargest;
    if (!finite) break;
    *next++ = static_cast<Number>(point.real());
    *next++ = static_cast<Number>(point.imag());
  }
  if (finite) return {};
  out->Clear();
  return Fail(FaultKind::kNumerical, "A position of the result is not finite in this precision.");
}

}  // namespace

Result<ShapeOptions> FromWire(const v1::DeformOptions& options, const app::Limits& limits) {
  ShapeOptions out;
  switch (options.mode()) {
    case v1::DEFORM_MODE_UNSPECIFIED:
    case v1::DEFORM_MODE_RIGID:
      out.deform.mode = DeformMode::kRigid;
      break;
    case v1::DEFORM_MODE_SIMILARITY:
      out.deform.mode = DeformMode::kSimilarity;
      break;
    case v1::DEFORM_MODE_BASELINE:
      out.deform.mode = DeformMode::kBaseline;
      break;
    default:
      return Fail(
          Fault(FaultKind::kInvalidOption,
                fmt::format("options.mode has the value {}, which this version does not know.",
                            static_cast<int>(options.mode())))
              .Field("options.mode")
              .Detail("value", std::to_string(options.mode())));
  }
  if (options.refine() > limits.max_refine) {
    Fault fault = Fault(FaultKind::kInvalidOption,
                        fmt::format("options.refine of {} is more than max_refine of {}.",
                                    options.refine(), limits.max_refine))
                      .Field("options.refine");
    return Fail(fault.Detail("value", std::to_string(options.refine()))
                    .Detail("quota", "max_refine")
                    .Detail("limit", std::to_string(limits.max_refine)));
  }
  out.deform.refine = static_cast<int>(options.refine());
  out.float64 = options.float64();
  out.flipped_ids = options.include_flipped_ids();
  return out;
}

Result<std::vector<Complex>> PicksFromWire(const google::protobuf::RepeatedField<double>& numbers) {
  const auto count = static_cast<std::size_t>(numbers.size());
  if (count % 2 != 0 || count > 2 * kMaxPicks) {
    return Fail(
        Fault(FaultKind::kArrayLength,
              fmt::format("pick_points has {} numbers; it needs x y pairs, at most {} of them.",
                          count, kMaxPicks))
            .Field("pick_points")
            .Detail("length", std::to_string(count))
            .Detail("limit", std::to_string(2 * kMaxPicks)));
  }
  std::vector<Complex> picks;
  picks.reserve(count / 2);
  for (int i = 0; i + 1 < numbers.size(); i += 2) {
    if (!std::isfinite(numbers[i]) || !std::isfinite(numbers[i + 1])) {
      return Fail(Fault(FaultKind::kNonFiniteTarget,
                        fmt::format("Pick point {} is NaN or infinite.", i / 2))
                      .Field(fmt::format("pick_points[{}]", i))
                      .Element(static_cast<std::uint32_t>(i / 2)));
    }
    picks.emplace_back(numbers[i], numbers[i + 1]);
  }
  return picks;
}

void PicksToWire(const Deformer& deformer, std::span<const Complex> picks, v1::Shape* out) {
  if (picks.empty()) return;
  const Picker picker(deformer.handles());
  for (const Complex point : picks) {
    v1::PickResult& result = *out->add_picks();
    const auto pick = picker.Find(deformer.positions(), point);
    if (!pick) continue;
    result.set_hit(true);
    result.set_triangle(pick->triangle);
    result.mutable_rest()->set_x(pick->rest.real());
    result.mutable_rest()->set_y(pick->rest.imag());
    result.mutable_barycentric()->Assign(pick->barycentric.begin(), pick->barycentric.end());
  }
}

Status ToWire(const Deformer& deformer, const ShapeQuality& quality, const ShapeOptions& options,
              v1::Shape* out, std::size_t lane) {
  const std::span<const Complex> positions = deformer.positions(lane);
  const auto packed = options.float64 ? ToDoubles(positions, out->mutable_positions64())
                                      : ToFloats(positions, out->mutable_positions());
  if (!packed) return packed;
  out->set_flipped_count(quality.flipped);
  if (options.flipped_ids) {
    const std::vector<std::uint32_t> flipped = deformer.FlippedTriangles(lane);
    out->mutable_flipped_ids()->Assign(flipped.begin(), flipped.end());
  }
  out->set_worst_handle_error(quality.worst_handle_error);
  const auto& handles = deformer.handles()->handles();
  if (!handles.empty()) out->set_worst_handle_id(handles[quality.worst_handle].handle.id);
  out->set_energy(quality.energy);
  out->set_mean_stretch(quality.mean_stretch);
  out->set_max_stretch(quality.max_stretch);
  return {};
}

Status ToFloats(std::span<const Complex> points, google::protobuf::RepeatedField<float>* out) {
  return Pack(points, out);
}

Status ToDoubles(std::span<const Complex> points, google::protobuf::RepeatedField<double>* out) {
  return Pack(points, out);
}

}  // namespace arap::rpc
