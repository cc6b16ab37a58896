// Flattening between the wire and the core.
#pragma once

#include "arap/base/result.h"
#include "arap/core/flattener.h"
#include "server/budget/limits.h"

namespace arap::v1 {
class FlattenRequest;
class FlattenResponse;
}  // namespace arap::v1

namespace arap::rpc {

// kLimitExceeded when the surface has more than max_flatten_triangles. Looks at lengths only.
Status CheckBudget(const v1::FlattenRequest& request, const app::Limits& limits);

// Everything that the request says beside the mesh, with the defaults of the interface filled in;
// numbers and vertices are for the core to judge (CheckFlattenOptions, Flatten). Faults:
// kInvalidOption (a value that this version does not know, a basis or weights that contradict the
// method, more refinements than max_refine), kArrayLength.
Result<FlattenOptions> FromWire(const v1::FlattenRequest& request, const app::Limits& limits);

// A fault of the core with its field in the spelling of the request.
Fault SpelledForFlatten(Fault fault);

// The answer as `request` asked for it, but for times and the cache. `response` is clear before.
// kNumerical when a number does not fit the precision of its field.
Status ToWire(const Flattening& flat, const v1::FlattenRequest& request,
              v1::FlattenResponse* response);

}  // namespace arap::rpc
