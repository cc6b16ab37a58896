// What only the server has beside the model's values, between it and the wire: entries, sessions,
// limits, deformers. The values themselves are converted in proto/convert.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/core/deformer.h"
#include "arap/model/limits.h"
#include "proto/convert/flatten.h"
#include "proto/convert/handles.h"
#include "proto/convert/mesh.h"
#include "proto/convert/shape.h"
#include "proto/convert/status.h"
#include "proto/convert/time.h"
#include "server/sessions/session.h"
#include "server/streams/targets.h"

namespace arap::v1 {
class CreateSessionRequest;
class FlattenRequest;
class HandleSetInfo;
class Session;
}  // namespace arap::v1
namespace arap::app {
struct HandleSetEntry;
struct MeshEntry;
}  // namespace arap::app

namespace arap::rpc {

using convert::FromWire;
using convert::PicksFromWire;
using convert::SetMicros;
using convert::ToGrpcStatus;
using convert::ToRpcStatus;
using convert::ToWire;

// Sessions. A ttl that is not set is 0. kInvalidOption for a ttl that no number of milliseconds can
// say.
Result<app::SessionSpec> FromWire(const v1::CreateSessionRequest& request);
void ToWire(const app::SessionView& view, v1::Session* out);

// A mesh, without the rigidity array, which only the client needs and has.
void ToWire(const app::MeshEntry& entry, v1::MeshInfo* out);

// Handles, with everything checked that needs no mesh: names, ranges, finiteness, barycentric
// weights. `field` is the name of the array in the request, for the fault's path. Faults:
// kInvalidName, kInvalidOption, kArrayLength.
Result<std::vector<Handle>> FromWire(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                                     std::string_view field);

// A handle set. Computes depths and the drawing order when a handle has a depth: for a worker.
void ToWire(const app::HandleSetEntry& entry, v1::HandleSetInfo* out);

// Targets; the ids point into `targets`.
std::vector<app::NamedTarget> FromWire(
    const google::protobuf::RepeatedPtrField<v1::HandleTarget>& targets);

// The targets of a frame in the order of the set; `order` is the set index of each column.
// kArrayLength and the faults of CheckTarget, with fields under "frames[index]".
Result<std::vector<Target>> FromWire(const v1::TrackFrame& frame, std::size_t index,
                                     const std::vector<std::size_t>& order);

// How to deform and what to answer.
struct ShapeOptions {
  DeformOptions deform;
  bool float64 = false;
  bool flipped_ids = false;
};

// kInvalidOption: an unknown mode, or refine above the limit.
Result<ShapeOptions> FromWire(const v1::DeformOptions& options, const Limits& limits);

// Positions and quality of a lane's last update, into a cleared `out`. kNumerical when a position
// does not fit the precision that was asked for.
Status ToWire(const Deformer& deformer, const ShapeQuality& quality, const ShapeOptions& options,
              v1::Shape* out, std::size_t lane = 0);

// Where `points` on the shape of `deformer` were at rest, one result each. Fault: that of `cancel`,
// asked between points.
Status PicksToWire(const Deformer& deformer, std::span<const Complex> points,
                   const CancelToken& cancel, v1::Shape* out);

// kLimitExceeded when the surface has more than max_flatten_triangles. Looks at lengths only.
Status CheckBudget(const v1::FlattenRequest& request, const Limits& limits);

}  // namespace arap::rpc
