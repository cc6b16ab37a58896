// Flattening between the model and the wire.
//
// Method, basis, weights and anchors that a request leaves open are those of the preset of its
// method (ArapOptions, LscmOptions… of arap/model/flatten.h), and so are the refinements, but never
// more than the server allows.
#pragma once

#include <cstdint>
#include <vector>

#include "arap/base/result.h"
#include "arap/model/drawing.h"
#include "arap/model/flatten.h"

namespace arap::v1 {
class FlattenRequest;
class FlattenResponse;
}  // namespace arap::v1

namespace arap::convert {

// Everything that the request says beside the mesh; numbers and vertices are for the core to judge.
// Faults: kInvalidOption (a value that this version does not know, a basis or weights that
// contradict the method, more refinements than max_refine), kArrayLength.
Result<FlattenOptions> FromWire(const v1::FlattenRequest& request, std::uint32_t max_refine);
// Refinements that are those of the method's preset are left to the server.
void ToWire(const FlattenOptions& options, v1::FlattenRequest* out);

// A fault of the core with its field in the spelling of the request.
Fault SpelledForFlatten(Fault fault);

// The answer as `request` asked for it, into a cleared `out`. kNumerical when a number does not fit
// the precision of its field.
Status ToWire(const Flattening& flat, const v1::FlattenRequest& request, v1::FlattenResponse* out);
// kInternal for lengths that no answer has. The wire has no times by phase.
Result<Flattening> FromWire(const v1::FlattenResponse& response);

// Drawings of layouts (drawing.cc): what is asked for; numbers are for core/drawing to judge. kInvalidOption for more than
// kMaxDrawings, and for a format or corners that this version does not know.
Result<std::vector<DrawingOptions>> DrawingsFromWire(const v1::FlattenRequest& request);
std::vector<NamedPart> PartsFromWire(const v1::FlattenRequest& request);
void ToWire(const std::vector<DrawingOptions>& drawings, const std::vector<NamedPart>& parts,
            v1::FlattenRequest* out);

std::vector<Drawing> DrawingsFromWire(const v1::FlattenResponse& response);
// Takes the bytes of the files.
void ToWire(std::vector<Drawing> drawings, v1::FlattenResponse* out);

}  // namespace arap::convert
