// Handles, handle sets and targets between the wire and the core.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/handle.h"
#include "server/streams/targets.h"

namespace google::protobuf {
template <typename T>
class RepeatedPtrField;
}
namespace arap::v1 {
class Handle;
class HandleSetInfo;
class HandleTarget;
class TrackFrame;
}  // namespace arap::v1
namespace arap::app {
struct HandleSetEntry;
}

namespace arap::rpc {

// Checks everything that needs no mesh: names, ranges, finiteness, barycentric weights. `field` is
// the name of the array in the request, for the fault's path. Faults: kInvalidName, kInvalidOption,
// kArrayLength.
Result<std::vector<Handle>> FromWire(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                                     std::string_view field);

// The ids point into `targets`.
std::vector<app::NamedTarget> FromWire(
    const google::protobuf::RepeatedPtrField<v1::HandleTarget>& targets);

// The targets of a frame in the order of the set; `order` is the set index of each column.
// kArrayLength and the faults of CheckTarget, with fields under "frames[index]".
Result<std::vector<Target>> FromWire(const v1::TrackFrame& frame, std::size_t index,
                                     const std::vector<std::size_t>& order);

// Computes depths and the drawing order when a handle has a depth: for a worker.
void ToWire(const app::HandleSetEntry& entry, v1::HandleSetInfo* out);

}  // namespace arap::rpc
