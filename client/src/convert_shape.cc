#include <algorithm>

#include "client/src/convert.h"

namespace arap::client::internal {
namespace {

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

PickResult FromWire(const v1::PickResult& pick) {
  PickResult out;
  out.hit = pick.hit();
  out.triangle = pick.triangle();
  out.rest_x = pick.rest().x();
  out.rest_y = pick.rest().y();
  const auto count = std::min(out.barycentric.size(), std::size_t(pick.barycentric_size()));
  std::copy_n(pick.barycentric().begin(), count, out.barycentric.begin());
  return out;
}

}  // namespace

void ToWire(const DeformOptions& options, v1::DeformOptions* out) {
  out->set_mode(ToWire(options.mode));
  out->set_refine(options.refine);
  out->set_float64(options.float64);
  out->set_include_flipped_ids(options.flipped_ids);
}

Shape FromWire(const v1::Shape& shape) {
  Shape out;
  out.positions = shape.positions64_size() > 0 ? Values<double>(shape.positions64())
                                               : Values<double>(shape.positions());
  out.sequence = shape.sequence();
  out.replaced = shape.replaced();
  out.flipped_count = shape.flipped_count();
  out.flipped_ids = Values<std::uint32_t>(shape.flipped_ids());
  out.worst_handle_error = shape.worst_handle_error();
  out.worst_handle_id = shape.worst_handle_id();
  out.energy = shape.energy();
  out.mean_stretch = shape.mean_stretch();
  out.max_stretch = shape.max_stretch();
  out.queue_micros = shape.queue_micros();
  out.solve_micros = shape.solve_micros();
  for (const v1::PickResult& pick : shape.picks()) out.picks.push_back(FromWire(pick));
  out.handle_set_revision = shape.handle_set_revision();
  return out;
}

}  // namespace arap::client::internal
