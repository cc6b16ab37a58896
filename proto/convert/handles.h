// Handles and targets between the model and the wire. Only what the model has no form for is
// checked here: missing anchors, lengths, unknown values.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/handle.h"

namespace arap::v1 {
class Handle;
class HandleInfo;
class HandleTarget;
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

}  // namespace arap::convert
