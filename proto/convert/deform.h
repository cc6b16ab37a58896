// Deformation between the model and the wire: handles and targets, options, the quality of shapes and
// picks; their positions are in positions.h. Only what the model has no form for is checked here:
// missing anchors, lengths, unknown values, limits of the server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/deform.h"
#include "arap/model/handle.h"

namespace google::protobuf {
template <typename Element>
class RepeatedField;
}
namespace arap::v1 {
class DeformOptions;
class Handle;
class HandleInfo;
class HandleTarget;
class PickResult;
class Shape;
class TrackFrame;
}  // namespace arap::v1

namespace arap::convert {

// `path` is where the handle is in the request ("handles[3]"), for the fault's field. Faults:
// kInvalidOption, kArrayLength.
Result<Handle> FromWire(const v1::Handle& handle, const std::string& path);
void ToWire(const Handle& handle, v1::Handle* out);

// Of the handle the wire has its id only.
PlacedHandle FromWire(const v1::HandleInfo& info);
void ToWire(const PlacedHandle& placed, v1::HandleInfo* out);

// All but the id.
Target TargetFromWire(const v1::HandleTarget& target);
void ToWire(const HandleTarget& target, v1::HandleTarget* out);

// One target per column, `columns` of them. kArrayLength with a field under `path` ("frames[3]").
Result<std::vector<Target>> FromWire(const v1::TrackFrame& frame, std::size_t columns,
                                     const std::string& path);
// Angles and scales are left out where no handle has one.
void ToWire(std::span<const Target> targets, v1::TrackFrame* out);

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

// All but the worst handle, whose name is on the wire and not its index.
ShapeQuality QualityFromWire(const v1::Shape& shape);
void ToWire(const ShapeQuality& quality, v1::Shape* out);

}  // namespace arap::convert
