// Deformation options and shapes between the wire and the core.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "arap/base/result.h"
#include "arap/core/deformer.h"
#include "arap/model/mesh.h"
#include "server/budget/limits.h"

namespace google::protobuf {
template <typename Element>
class RepeatedField;
}
namespace arap::v1 {
class DeformOptions;
class Shape;
}  // namespace arap::v1

namespace arap::rpc {

// How to deform and what to answer.
struct ShapeOptions {
  DeformOptions deform;
  bool float64 = false;
  bool flipped_ids = false;
};

// kInvalidOption: an unknown mode, or refine above the limit.
Result<ShapeOptions> FromWire(const v1::DeformOptions& options, const app::Limits& limits);

inline constexpr std::size_t kMaxPicks = 1024;

// Points to map back to rest, x y x y…. kArrayLength: an odd length or more than kMaxPicks points;
// kNonFiniteTarget: NaN or infinity.
Result<std::vector<Complex>> PicksFromWire(const google::protobuf::RepeatedField<double>& numbers);

// Where `picks` on the shape of `deformer` were at rest, one result each.
void PicksToWire(const Deformer& deformer, std::span<const Complex> picks, v1::Shape* out);

// Positions and quality of a lane's last update, into a cleared `out`. kNumerical when a
// position does not fit the precision that was asked for.
Status ToWire(const Deformer& deformer, const ShapeQuality& quality, const ShapeOptions& options,
              v1::Shape* out, std::size_t lane = 0);

// x y x y…; kNumerical when a coordinate is not a finite float.
Status ToFloats(std::span<const Complex> points, google::protobuf::RepeatedField<float>* out);
Status ToDoubles(std::span<const Complex> points, google::protobuf::RepeatedField<double>* out);

}  // namespace arap::rpc
