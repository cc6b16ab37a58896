// Deformation options and shapes between the wire and the core.
#pragma once

#include <span>

#include "core/base/result.h"
#include "core/deform/deformer.h"
#include "core/mesh/mesh.h"

namespace google::protobuf {
template <typename Element>
class RepeatedField;
}
namespace arap::v1 {
class DeformOptions;
class Shape;
}  // namespace arap::v1
namespace arap::app {
struct Limits;
}

namespace arap::rpc {

// How to deform and what to answer.
struct ShapeOptions {
  DeformOptions deform;
  bool float64 = false;
  bool flipped_ids = false;
};

// kInvalidOption: an unknown mode, or refine above the limit.
Result<ShapeOptions> FromWire(const v1::DeformOptions& options, const app::Limits& limits);

// Picking on the deformed shape is shaped, not yet served: kUnimplemented unless there are none.
Status CheckPicks(int pick_numbers);

// Positions and quality of the last Update of `deformer`, into a cleared `out`. kNumerical when a
// position does not fit the precision that was asked for.
Status ToWire(const Deformer& deformer, const ShapeQuality& quality, const ShapeOptions& options,
              v1::Shape* out);

// x y x y…; kNumerical when a coordinate is not a finite float.
Status ToFloats(std::span<const Complex> points, google::protobuf::RepeatedField<float>* out);
Status ToDoubles(std::span<const Complex> points, google::protobuf::RepeatedField<double>* out);

}  // namespace arap::rpc
