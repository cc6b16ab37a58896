// Deformation options, deformed shapes and picks between the model and the wire.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/deform.h"

namespace google::protobuf {
template <typename Element>
class RepeatedField;
}
namespace arap::v1 {
class DeformOptions;
class PickResult;
class Shape;
}  // namespace arap::v1

namespace arap::convert {

// kInvalidOption: an unknown mode, or more refinements than `max_refine`.
Result<DeformOptions> FromWire(const v1::DeformOptions& options, std::uint32_t max_refine);
void ToWire(const DeformOptions& options, v1::DeformOptions* out);

inline constexpr std::size_t kMaxPicks = 1024;

// Points to map back to rest, x y x y…. kArrayLength: an odd length or more than kMaxPicks points;
// kNonFiniteTarget: NaN or infinity.
Result<std::vector<Complex>> PicksFromWire(const google::protobuf::RepeatedField<double>& numbers);

// Nothing for a point that lies in no triangle.
std::optional<Pick> FromWire(const v1::PickResult& result);
void ToWire(const std::optional<Pick>& pick, v1::PickResult* out);

// Positions into a cleared `out`, in double precision or in single. kNumerical when one does not
// fit.
Status ToWire(std::span<const Complex> positions, bool float64, v1::Shape* out);
// Whichever precision there is. kInternal for a length that no positions have.
Result<std::vector<Complex>> PositionsFromWire(const v1::Shape& shape);

// All but the worst handle, whose name is on the wire and not its index.
ShapeQuality QualityFromWire(const v1::Shape& shape);
void ToWire(const ShapeQuality& quality, v1::Shape* out);

}  // namespace arap::convert
