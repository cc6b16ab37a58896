// What only the server has beside the model's values, between it and the wire: entries, sessions,
// limits, shapes. The values themselves are converted in proto/convert.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "arap/base/result.h"
#include "arap/core/deformer.h"
#include "arap/model/limits.h"
#include "proto/convert/deform.h"
#include "proto/convert/flatten.h"
#include "proto/convert/mesh.h"
#include "proto/convert/plain.h"
#include "proto/convert/positions.h"
#include "proto/convert/status.h"
#include "server/runtime/clock.h"
#include "server/sessions/session.h"
#include "server/streams/targets.h"

namespace arap {
class RegisteredMesh;
}
namespace arap::v1 {
class CreateSessionRequest;
class DeformTrackRequest;
class FlattenRequest;
class HandleSetInfo;
class Job;
class Session;
class StreamDeformRequest;
class StreamDeformResponse;
enum Delivery : int;
}  // namespace arap::v1
namespace arap::app {
struct HandleSetEntry;
class LiveSet;
struct JobView;
struct MeshEntry;
struct StreamAnswer;
struct StreamMessage;
}  // namespace arap::app

namespace arap::rpc {

using convert::Append;
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

// Handles with their names checked; numbers are for the core to judge. `field` is the name of the
// array in the request, for the fault's path. Faults: kInvalidName, kInvalidOption, kArrayLength.
Result<std::vector<Handle>> FromWire(const google::protobuf::RepeatedPtrField<v1::Handle>& handles,
                                     std::string_view field);

// A handle set. Computes depths and the drawing order when a handle has a depth: for a worker.
void ToWire(const app::HandleSetEntry& entry, v1::HandleSetInfo* out);

// Targets; the ids point into `targets`.
std::vector<app::NamedTarget> FromWire(
    const google::protobuf::RepeatedPtrField<v1::HandleTarget>& targets);

// Whether a stream that was opened with it is answered for the latest update only. kInvalidOption for a value that this
// version does not know.
Result<bool> LatestOnly(v1::Delivery delivery);

// Adds to the message of an answer what its policy knows of it.
void Complete(const app::StreamAnswer& answer, v1::StreamDeformResponse& message);

// The targets of a frame of a track in the order of the set; `order` is the set index of each
// column. kArrayLength and the faults of CheckTarget, with fields under "frames[frame]".
Result<std::vector<Target>> FromWire(const v1::DeformTrackRequest& request, std::size_t frame,
                                     const std::vector<std::size_t>& order);

// A message of a stream as the policy sees it. What it points to stays in `request`.
app::StreamMessage FromWire(const v1::StreamDeformRequest& request, const Limits& limits);

// How to deform and what to answer.
struct ShapeOptions {
  DeformOptions deform;
  convert::PositionFormat format;
  std::vector<std::uint32_t> vertices;  // whose positions, in this order; none stand for all
  bool flipped_ids = false;             // of shapes that are measured

  // What it holds beside itself.
  std::size_t bytes() const { return vertices.size() * sizeof(vertices.front()); }
};

// kInvalidOption: an unknown mode, or refine above the limit; the faults of FormatFromWire and
// SubsetFromWire.
Result<ShapeOptions> FromWire(const v1::DeformOptions& options, const Limits& limits,
                              const RegisteredMesh& mesh);

// How long a shape waited and, with others that were computed together, is being worked on.
struct ShapeTimes {
  double queue_micros = 0;
  const runtime::WallTimer& working;
  std::size_t shapes = 1;
};

// The shape of a lane's last update, of this quality, into a cleared `out`; sequence and replaced
// are left to the caller. `picks` are points on it to map back to rest, one result each. Faults:
// kNumerical when a position does not fit the precision that was asked for; that of `cancel`, asked
// between picks.
Status ToWire(const app::LiveSet& set, const ShapeQuality& quality, const ShapeOptions& options,
              std::span<const Complex> picks, const CancelToken& cancel, const ShapeTimes& times,
              v1::Shape* out, std::size_t lane = 0);

// How a job stands.
void ToWire(const app::JobView& view, v1::Job* out);

// kLimitExceeded when the surface has more than max_flatten_triangles. Looks at lengths only.
Status CheckBudget(const v1::FlattenRequest& request, const Limits& limits);

}  // namespace arap::rpc
